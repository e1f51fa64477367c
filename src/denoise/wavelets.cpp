#include "denoise/wavelets.h"

#include "base/parallel.h"
#include "denoise/lanes.h"

#include <algorithm>
#include <utility>

namespace abbe {

namespace {

constexpr int kLevels = 5;
static_assert(2 << (kLevels - 1) <= Plane::kBorder - kLanes); // the farthest pixel that is looked at
constexpr float kNoiseWidths = 3; // standard deviations of noise that a difference of colour may have
constexpr int kVarianceRadius = 3;
constexpr float kFeatureWidth = 0.05f; // difference of features that halves a weight, roughly

// One half between two levels: its colours, and of the compressed ones the mean variance of a channel.
struct Level {
    std::vector<Plane> colours;
    Plane variance;
};

// Smoother than that of the guide: a pixel is compared with few others, and not with their surroundings.
Plane meanVariance(const HalfBuffers& guide) {
    Plane variance(guide.variances[0].width(), guide.variances[0].height());
    for (int y = 0; y < variance.height(); ++y)
        for (int x = 0; x < variance.width(); ++x)
            for (const Plane& p : guide.variances) variance.row(y)[x] += p.row(y)[x] / 3;
    variance.extend();
    return boxFilter(variance, kVarianceRadius);
}

// The squared distance of pixels in units of what separates surfaces and of the noise of `guide`.
struct Distance {
    const std::vector<Plane>& features;
    const std::vector<Plane>& guide; // compressed colours
    const Plane& variance;

    Lanes operator()(int x, int y, int u, int v) const {
        const auto sumOfSquares = [&](const std::vector<Plane>& planes) {
            Lanes sum{};
            for (const Plane& plane : planes) {
                const Lanes d = load(plane.row(y) + x) - load(plane.row(v) + u);
                sum += d * d;
            }
            return sum;
        };
        const Lanes noise = 3.f * (load(variance.row(y) + x) + load(variance.row(v) + u)) + kColourEpsilon;
        return sumOfSquares(features) * (1 / (kFeatureWidth * kFeatureWidth)) +
               sumOfSquares(guide) / (kNoiseWidths * kNoiseWidths * noise);
    }
};

// Eight pixels of the next level, each from 5 × 5 that are `step` apart, with the weights of a cubic B-spline. Beyond
// the edges of the picture its border counts.
void filterPixels(const Level& from, const Distance& distance, int x, int y, int step, Level& to) {
    constexpr std::array<float, 5> kSpline{1 / 16.f, 1 / 4.f, 3 / 8.f, 1 / 4.f, 1 / 16.f};
    Lanes sum[3] = {}, variance{}, total{};
    for (int j = -2; j <= 2; ++j)
        for (int i = -2; i <= 2; ++i) {
            const int u = x + i * step, v = y + j * step;
            const float spline = kSpline[static_cast<std::size_t>(i + 2)] * kSpline[static_cast<std::size_t>(j + 2)];
            const Lanes w = spline * decay(distance(x, y, u, v));
            for (std::size_t c = 0; c < 3; ++c) sum[c] += w * load(from.colours[c].row(v) + u);
            variance += w * w * load(from.variance.row(v) + u);
            total += w;
        }
    for (std::size_t c = 0; c < 3; ++c) store(to.colours[c].row(y) + x, sum[c] / total);
    store(to.variance.row(y) + x, variance / (total * total));
}

Level nextLevel(const Level& from, const std::vector<Plane>& features, int step) {
    const int width = from.variance.width(), height = from.variance.height();
    Level to{{3, Plane(width, height)}, Plane(width, height)};
    const std::vector<Plane> guide = compressed(from.colours);
    const Distance distance{features, guide, from.variance};
    parallelFor(static_cast<std::size_t>(height), [&](std::size_t y) {
        for (int x = 0; x < width; x += kLanes) filterPixels(from, distance, x, static_cast<int>(y), step, to);
    });
    for (Plane& plane : to.colours) plane.extend();
    to.variance.extend();
    return to;
}

} // namespace

DenoisedHalves denoiseByWavelets(const PreparedInput& input) {
    const Plane variance = meanVariance(input.guide);
    std::array<Level, 2> halves{Level{input.shading[0], variance}, Level{input.shading[1], variance}};
    for (int level = 0; level < kLevels; ++level) {
        for (Level& half : halves) half = nextLevel(half, input.features, 1 << level);
    }
    DenoisedHalves result;
    for (std::size_t half = 0; half < 2; ++half) {
        for (std::size_t c = 0; c < 3; ++c) result[half][c] = std::move(halves[half].colours[c]);
        multiply(result[half], input.divisor);
    }
    return result;
}

} // namespace abbe
