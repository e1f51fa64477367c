#include "denoise/half_buffers.h"
#include "denoise/regression.h"

#include <cmath>
#include <doctest/doctest.h>
#include <random>

using namespace abbe;

namespace {

template <typename F> Plane makePlane(int width, int height, const F& value) {
    Plane plane(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) plane.row(y)[x] = static_cast<float>(value(x, y));
    plane.extend();
    return plane;
}

// A guide that finds all pixels alike.
struct FlatGuide {
    Plane value, variance;
    Guide guide;

    FlatGuide(int width, int height) : value(width, height), variance(width, height) {
        guide = {{&value}, {&variance}, 1e-6f};
    }
};

Modulation plainModulation(int width, int height) {
    const Plane one = makePlane(width, height, [](int, int) { return 1; });
    return {{one, one, one}, Plane(width, height)};
}

double largestError(const Plane& a, const Plane& b) {
    double largest = 0;
    for (int y = 0; y < a.height(); ++y)
        for (int x = 0; x < a.width(); ++x)
            largest = std::max(largest, std::abs(static_cast<double>(a.row(y)[x]) - b.row(y)[x]));
    return largest;
}

// Features of many kinds: ramps, an edge, texture, curvature; as many as asked for.
std::vector<Plane> makeFeatures(int width, int height, std::size_t count) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(0, 1);
    std::vector<Plane> features;
    features.push_back(makePlane(width, height, [&](int x, int) { return 0.02 * x; }));
    features.push_back(makePlane(width, height, [&](int x, int y) { return x + y > 40 ? 1 : 0; }));
    features.push_back(makePlane(width, height, [&](int, int) { return uniform(random); }));
    features.push_back(makePlane(width, height, [&](int x, int y) { return std::sin(0.3 * x) * std::cos(0.2 * y); }));
    features.push_back(makePlane(width, height, [&](int x, int y) { return (x / 3 + y / 3) % 2; }));
    features.push_back(makePlane(width, height, [&](int, int y) { return 1e-3 * y * y; }));
    features.push_back(makePlane(width, height, [&](int, int) { return uniform(random); }));
    features.resize(count);
    return features;
}

} // namespace

TEST_CASE("a picture that is an affine function of its features comes out as it is") {
    constexpr int kWidth = 45, kHeight = 38; // no multiples of a tile or of the lanes
    const FlatGuide flat(kWidth, kHeight);
    for (const std::size_t count : {1, 3, 4, 6, 7}) {
        CAPTURE(count);
        const std::vector<Plane> features = makeFeatures(kWidth, kHeight, count);
        std::vector<Plane> colours;
        for (int c = 0; c < 3; ++c)
            colours.push_back(makePlane(kWidth, kHeight, [&](int x, int y) {
                double value = 0.5 + 0.1 * c;
                for (std::size_t i = 0; i < count; ++i)
                    value += (0.3 * static_cast<double>(i) - c) * features[i].row(y)[x];
                return value;
            }));
        for (const ColourPlanes& result : regress(colours, plainModulation(kWidth, kHeight), features, flat.guide, 5))
            for (std::size_t c = 0; c < 3; ++c) CHECK(largestError(result[c], colours[c]) < 2e-3);
    }
}

TEST_CASE("the product of an affine function of the features and the modulation comes out as it is, faded or not") {
    constexpr int kWidth = 45, kHeight = 38;
    const FlatGuide flat(kWidth, kHeight);
    const std::vector<Plane> features = makeFeatures(kWidth, kHeight, 3);
    const Plane albedo = makePlane(kWidth, kHeight, [](int x, int y) { return 0.05 + 0.1 * ((x * 7 + y * 3) % 9); });
    for (const float fade : {0.f, 0.4f, 1.f}) {
        const Plane faded = makePlane(kWidth, kHeight, [&](int, int) { return fade; });
        const std::vector<Plane> colours(3, makePlane(kWidth, kHeight, [&](int x, int y) {
                                             const double light =
                                                 2 + features[0].row(y)[x] - 0.5 * features[2].row(y)[x];
                                             return light * (albedo.row(y)[x] + fade * (1 - albedo.row(y)[x]));
                                         }));
        for (const ColourPlanes& r : regress(colours, {{albedo, albedo, albedo}, faded}, features, flat.guide, 5))
            for (std::size_t c = 0; c < 3; ++c) CHECK(largestError(r[c], colours[c]) < 2e-3);
    }
}

TEST_CASE("features that say nothing are left out") {
    constexpr int kSize = 33;
    const FlatGuide flat(kSize, kSize);
    // Constant, twice the same, and one that depends on another.
    std::vector<Plane> features = makeFeatures(kSize, kSize, 1);
    features.push_back(features[0]);
    features.push_back(makePlane(kSize, kSize, [](int, int) { return 3; }));
    features.push_back(makePlane(kSize, kSize, [&](int x, int y) { return 1 - 2 * features[0].row(y)[x]; }));
    const std::vector<Plane> colours(3, makePlane(kSize, kSize, [](int x, int) { return 1 + 0.04 * x; }));
    for (const ColourPlanes& result : regress(colours, plainModulation(kSize, kSize), features, flat.guide, 5))
        for (std::size_t c = 0; c < 3; ++c) CHECK(largestError(result[c], colours[c]) < 2e-3);
}

TEST_CASE("without features and with equal weights the result is a mean of means over windows") {
    constexpr int kSize = 61, kRadius = 9;
    const FlatGuide flat(kSize, kSize);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform(0, 1);
    const Plane noise = makePlane(kSize, kSize, [&](int, int) { return uniform(random); });
    const ColourPlanes result = regress({noise, noise, noise}, plainModulation(kSize, kSize), {}, flat.guide, 5)[0];
    const Plane expected = boxFilter(boxFilter(noise, kRadius), kRadius);
    // Inside, where no window is cut by the edge.
    double largest = 0;
    for (int y = 2 * kRadius; y < kSize - 2 * kRadius; ++y)
        for (int x = 2 * kRadius; x < kSize - 2 * kRadius; ++x)
            largest = std::max(largest, std::abs(static_cast<double>(result[0].row(y)[x]) - expected.row(y)[x]));
    CHECK(largest < 1e-5);
}

TEST_CASE("weights: 1 among pixels that differ by noise alone, 0 across an edge, 0 outside the picture") {
    constexpr int kSize = 40;
    std::mt19937 random(11);
    std::normal_distribution<float> noise(0, 0.1f);
    const Plane value = makePlane(kSize, kSize, [&](int x, int) { return (x < 20 ? 0 : 3) + noise(random); });
    const Plane variance = makePlane(kSize, kSize, [](int, int) { return 0.01; });
    PatchWeights weights(5);
    weights.compute({{&value}, {&variance}, 1e-6f}, {0, 0, 32, 32});
    CHECK(weights.row(0, 0, 10)[10] == 1);
    double sum = 0;
    for (int dy = -5; dy <= 5; ++dy)
        for (int dx = -5; dx <= 5; ++dx) sum += weights.row(dx, dy, 16)[10] / 121.;
    CHECK(sum > 0.7);
    CHECK(weights.row(5, 0, 16)[17] < 1e-6f); // from 17 to 22
    CHECK(weights.row(-5, 0, 16)[4] == 0);
    CHECK(weights.row(-5, 0, 16)[5] > 0);
    CHECK(weights.row(0, -1, 0)[10] == 0);
    const Plane narrow = makePlane(37, 9, [](int, int) { return 1; });
    weights.compute({{&narrow}, {&narrow}, 1e-6f}, {32, 0, 8, 9}); // three columns of the tile lie outside
    CHECK(weights.row(0, 0, 3)[4] == 1);
    CHECK(weights.row(0, 0, 3)[5] == 0);
    CHECK(weights.row(-1, 0, 3)[5] == 0);
    // (A − B)²/2 is the variance of a half.
    const Plane other = makePlane(kSize, kSize, [&](int x, int) { return (x < 20 ? 0 : 3) + noise(random); });
    const HalfBuffers halves({value}, {other}, 4);
    double mean = 0;
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) mean += halves.variances[0].row(y)[x] / (kSize * kSize);
    CHECK(mean == doctest::Approx(0.01).epsilon(0.1));
}

// Where the truth is 0, the estimate is ((D_A + D_B)/2)² and products of independent deviations.
TEST_CASE("the squared error of the mean of two halves") {
    std::mt19937 random(17);
    std::normal_distribution<float> noise(0, 1);
    std::array<std::vector<Plane>, 4> planes; // A, B, D_A, D_B
    for (auto& kind : planes)
        for (int c = 0; c < 3; ++c) kind.push_back(makePlane(20, 12, [&](int, int) { return noise(random); }));
    const HalfBuffers noisy(planes[0], planes[1], 4);
    const DenoisedHalves denoised{ColourPlanes{planes[2][0], planes[2][1], planes[2][2]},
                                  ColourPlanes{planes[3][0], planes[3][1], planes[3][2]}};
    const ColourPlanes error = squaredError(noisy, denoised);
    for (std::size_t c = 0; c < 3; ++c) {
        const Plane expected = makePlane(20, 12, [&](int x, int y) {
            const double a = planes[0][c].row(y)[x], b = planes[1][c].row(y)[x];
            const double da = planes[2][c].row(y)[x], db = planes[3][c].row(y)[x];
            return (da + db) * (da + db) / 4 + a * b - da * b - db * a;
        });
        CHECK(largestError(error[c], expected) < 1e-5);
    }
}
