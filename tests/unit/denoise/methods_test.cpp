#include "denoise/methods.h"

#include <cmath>
#include <doctest/doctest.h>
#include <random>

using namespace abbe;

namespace {

constexpr int kWidth = 90, kHeight = 71;

// What a candidate says at one pixel of one half.
template <typename F> DenoisedHalves makeHalves(const F& value) {
    DenoisedHalves halves;
    for (ColourPlanes& half : halves)
        for (Plane& plane : half) {
            plane = Plane(kWidth, kHeight);
            for (int y = 0; y < kHeight; ++y)
                for (int x = 0; x < kWidth; ++x) plane.row(y)[x] = static_cast<float>(value(x, y));
            plane.extend();
        }
    return halves;
}

class Noise {
  public:
    explicit Noise(unsigned seed) : random_(seed) {}
    double operator()(double deviation) { return std::normal_distribution<double>(0, deviation)(random_); }

  private:
    std::mt19937 random_;
};

double truth(int x, int y) { return 0.2 + 0.1 * std::sin(0.1 * x) * std::cos(0.07 * y); }

HalfBuffers noisyPicture(Noise& noise, double deviation = 0.1) {
    const DenoisedHalves halves = makeHalves([&](int x, int y) { return truth(x, y) + noise(deviation); });
    return {{halves[0].begin(), halves[0].end()}, {halves[1].begin(), halves[1].end()}, 2};
}

// Of the mean of both halves in the first channel, at the columns from x0 on.
double meanSquaredError(const DenoisedHalves& d, int x0 = 0, int x1 = kWidth) {
    double sum = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = x0; x < x1; ++x)
            for (std::size_t c = 0; c < 3; ++c)
                sum += std::pow((d[0][c].row(y)[x] + d[1][c].row(y)[x]) / 2 - truth(x, y), 2);
    return sum / (3. * kHeight * (x1 - x0));
}

double estimatedError(const HalfBuffers& noisy, const DenoisedHalves& d) {
    double sum = 0;
    for (const Plane& plane : squaredError(noisy, d))
        for (const float v : plane.pixels()) sum += v;
    return sum / (3. * kWidth * kHeight);
}

} // namespace

TEST_CASE("a single candidate is the mixture") {
    Noise noise(1);
    const HalfBuffers noisy = noisyPicture(noise);
    const DenoisedHalves only = makeHalves([&](int x, int y) { return truth(x, y) + noise(0.02); });
    const Mixture m = mix(noisy, {only});
    for (std::size_t half = 0; half < 2; ++half)
        for (std::size_t c = 0; c < 3; ++c)
            for (const DenoisedHalves* d : {&m.picture, &m.validated}) {
                double largest = 0;
                for (int y = 0; y < kHeight; ++y)
                    for (int x = 0; x < kWidth; ++x)
                        largest =
                            std::max(largest, std::abs(double((*d)[half][c].row(y)[x]) - only[half][c].row(y)[x]));
                CHECK(largest < 1e-6);
            }
}

TEST_CASE("each candidate wins where it is better") {
    Noise noise(2);
    const HalfBuffers noisy = noisyPicture(noise);
    const auto wrongAt = [&](bool left) {
        return makeHalves([&](int x, int y) { return truth(x, y) + ((x < kWidth / 2) == left ? 0.15 : 0.); });
    };
    const Mixture m = mix(noisy, {wrongAt(true), wrongAt(false)});
    for (const DenoisedHalves* d : {&m.picture, &m.validated}) {
        CHECK(meanSquaredError(*d, 0, kWidth / 2 - 10) < 0.02 * 0.15 * 0.15);
        CHECK(meanSquaredError(*d, kWidth / 2 + 10) < 0.02 * 0.15 * 0.15);
    }
}

TEST_CASE("a pixel where a candidate is far off does not decide for its neighbours") {
    Noise noise(3);
    const HalfBuffers noisy = noisyPicture(noise);
    const auto isSpot = [](int x, int y) { return x % 11 == 5 && y % 11 == 5; };
    const DenoisedHalves spotted = makeHalves([&](int x, int y) { return truth(x, y) + (isSpot(x, y) ? 5 : 0); });
    const DenoisedHalves wrong = makeHalves([](int x, int y) { return truth(x, y) + 0.15; });
    const Mixture m = mix(noisy, {wrong, spotted});
    double sum = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            if (!isSpot(x, y)) sum += std::pow(m.picture[0][0].row(y)[x] - truth(x, y), 2) / (kWidth * kHeight);
    CHECK(sum < 0.1 * 0.15 * 0.15);
}

// Ten candidates that are equally good: their mean is better than any, and the choice among them is all chance.
TEST_CASE("candidates that cannot be told apart are averaged, and the choice does not flatter the estimate") {
    double error = 0, single = 0, flattered = 0, validated = 0, real = 0;
    for (unsigned seed = 1; seed <= 6; ++seed) {
        Noise noise(seed);
        const HalfBuffers noisy = noisyPicture(noise, 0.05);
        std::vector<DenoisedHalves> candidates;
        for (int k = 0; k < 10; ++k)
            candidates.push_back(makeHalves([&](int x, int y) { return truth(x, y) + noise(0.03); }));
        const Mixture m = mix(noisy, candidates);
        error += meanSquaredError(m.picture);
        single += meanSquaredError(candidates[0]);
        flattered += estimatedError(noisy, m.picture);
        validated += estimatedError(noisy, m.validated);
        real += meanSquaredError(m.validated);
    }
    MESSAGE("of one " << single << ", of all " << error << " ~ " << flattered << ", validated " << real << " ~ "
                      << validated);
    CHECK(error < 0.25 * single);
    CHECK(flattered < 0.75 * error);
    CHECK(std::abs(validated / real - 1) < 0.3);
}
