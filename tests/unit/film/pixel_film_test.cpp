#include "base/parallel.h"
#include "film/pixel_film.h"
#include "spectrum/color_space.h"

#include <cmath>
#include <doctest/doctest.h>
#include <random>

using namespace abbe;

namespace {

PixelFilter box() { return {FilterShape::box, 0.5}; }

} // namespace

TEST_CASE("sums of 1e8 samples keep seven digits") {
    // Six million additions of 16 samples' sums; in single precision the count alone stops at 2^24.
    PixelFilm film({0, 0, 1, 1}, box(), 1);
    constexpr std::uint32_t kBatches = 6'250'000, kBatch = 16;
    const double value = 0.1;
    for (std::uint32_t i = 0; i < kBatches; ++i) film.add(0, 0, 0, Xyz{1, value, 0.3} * kBatch, kBatch);
    CHECK(film.samples(0, 0) == 100'000'000);
    CHECK(std::abs(film.mean(0, 0).y / value - 1) < 1e-7);
    CHECK(std::abs(film.mean(0, 0).x - 1) < 1e-7);
}

TEST_CASE("variance of 1000 ± 1 does not cancel") {
    constexpr int kReplicates = 8;
    PixelFilm film({0, 0, 1, 1}, box(), kReplicates);
    // Replicate means 1000 ± 1 in turn: s² = 8/7, s²/8 = 1/7.
    for (int r = 0; r < kReplicates; ++r) film.add(0, 0, r, Xyz{0, 1000.0 + (r % 2 ? 1 : -1), 0} * 1000, 1000);
    CHECK(*film.variance(0, 0) == doctest::Approx(1.0 / 7).epsilon(1e-6));
    CHECK(film.mean(0, 0).y == doctest::Approx(1000).epsilon(1e-12));
}

TEST_CASE("variance is that of the mean, also for replicates of different size") {
    std::mt19937 random(3);
    std::normal_distribution<double> normal(5, 2);
    constexpr int kPixels = 20000;
    constexpr std::uint32_t kCounts[] = {16, 16, 8, 4};
    PixelFilm film({0, 0, kPixels, 1}, box(), 4);
    double meanError = 0, estimate = 0;
    for (int x = 0; x < kPixels; ++x) {
        for (int r = 0; r < 4; ++r) {
            double sum = 0;
            for (std::uint32_t i = 0; i < kCounts[r]; ++i) sum += normal(random);
            film.add(x, 0, r, Xyz{0, sum, 0}, kCounts[r]);
        }
        meanError += square(film.mean(x, 0).y - 5) / kPixels;
        estimate += *film.variance(x, 0) / kPixels;
    }
    CHECK(meanError == doctest::Approx(4.0 / 44).epsilon(0.03)); // σ²/N
    // Each term estimates its replicate's variance from deviations of unequal parts: right to the first order.
    CHECK(estimate == doctest::Approx(4.0 / 44).epsilon(0.15));
}

TEST_CASE("variance from two equal replicates is unbiased; pooling narrows it") {
    std::mt19937 random(5);
    std::normal_distribution<double> normal(3, 1);
    PixelFilm film({0, 0, 100, 100}, box(), 2);
    for (int y = 0; y < 100; ++y)
        for (int x = 0; x < 100; ++x)
            for (int r = 0; r < 2; ++r) film.add(x, y, r, Xyz{0, normal(random) * 4, 0}, 4); // mean of a replicate ± 1
    double sum = 0, spread = 0, pooledSpread = 0;
    for (int y = 0; y < 100; ++y)
        for (int x = 0; x < 100; ++x) {
            sum += *film.variance(x, y) / 1e4;
            spread += square(*film.variance(x, y) - 0.5) / 1e4;
            pooledSpread += square(*film.pooledVariance(x, y) - 0.5) / 1e4;
        }
    CHECK(sum == doctest::Approx(0.5).epsilon(0.05));
    CHECK(pooledSpread < spread / 30); // 49 neighbours inside, fewer at the border
    // Var of an image value 3 ± √½: relative to 9 + 0.09.
    CHECK(film.relativeNoise() == doctest::Approx(std::sqrt(0.5 / 9.09)).epsilon(0.1));
}

TEST_CASE("noise of two pixels by hand") {
    PixelFilm film({0, 0, 2, 1}, box(), 2);
    const double means[2][2] = {{3, 5}, {-1, 1}}; // 4 ± 1 and 0 ± 1
    for (int x = 0; x < 2; ++x)
        for (int r = 0; r < 2; ++r) film.add(x, 0, r, Xyz{0, means[x][r] * 8, 0}, 8);
    // The image's mean is 2, so ε = 0.04.
    CHECK(film.relativeNoise() == doctest::Approx(std::sqrt((1 / 16.04 + 1 / 0.04) / 2)));
}

TEST_CASE("noise needs two replicates with samples") {
    PixelFilm one({0, 0, 2, 2}, box(), 1);
    one.add(0, 0, 0, Xyz{1, 1, 1}, 1);
    CHECK(!one.variance(0, 0));
    CHECK(one.relativeNoise() == 0);
    PixelFilm two({0, 0, 2, 2}, box(), 2);
    CHECK(two.relativeNoise() == 0);
    two.add(0, 0, 0, Xyz{1, 1, 1}, 1);
    CHECK(!two.variance(0, 0));
    CHECK(!two.pooledVariance(1, 1));
    two.add(0, 0, 1, Xyz{3, 3, 3}, 1);
    CHECK(*two.variance(0, 0) == doctest::Approx(1)); // means 1 and 3: s² = 2, s²/2
    CHECK(two.relativeNoise() > 0);
    const auto image = two.resolve(rgb::ap0.fromXyz(), 1);
    CHECK(image.variance[0] == doctest::Approx(1));
    CHECK(std::isinf(image.variance[1]));
    CHECK(std::isinf(two.resolve(rgb::ap0.fromXyz(), 1e-200).variance[1])); // and not infinity times 0
    PixelFilm black({0, 0, 2, 2}, box(), 2);
    for (int i = 0; i < 8; ++i) black.add(i % 2, i / 2 % 2, i / 4, {}, 4);
    CHECK(black.relativeNoise() == 0);
}

TEST_CASE("films of one pixel, of one long row and cropped") {
    PixelFilm pixel({0, 0, 1, 1}, box(), 2);
    pixel.add(0, 0, 1, Xyz{1, 2, 3}, 1);
    CHECK(pixel.mean(0, 0).y == 2);
    CHECK(pixel.resolve(rgb::ap0.fromXyz(), 1).r.size() == 1);

    PixelFilm row({0, 0, 32768, 1}, box(), 2);
    row.add(32767, 0, 1, Xyz{1, 2, 3}, 1);
    row.add(0, 0, 0, Xyz{1, 4, 3}, 1);
    CHECK(row.mean(32767, 0).y == 2);
    CHECK(row.mean(0, 0).y == 4);
    CHECK(row.mean(32766, 0).y == 0);
    CHECK(row.resolve(rgb::ap1.fromXyz(), 1).g.size() == 32768);

    PixelFilm crop({10, 20, 13, 22}, box(), 1);
    crop.add(12, 21, 0, Xyz{0, 5, 0}, 1);
    CHECK(crop.mean(12, 21).y == 5);
    CHECK(crop.mean(10, 20).y == 0);
    CHECK(crop.resolve(rgb::ap0.fromXyz(), 1).g.back() == doctest::Approx(5 * 1.3733130458));
    CHECK(PixelFilm::memoryBytes({0, 0, 65536, 32768}, 2) == 104ull << 31);
}

TEST_CASE("resolving uses the standard's matrix, scales, and keeps negatives") {
    PixelFilm film({0, 0, 1, 1}, box(), 1);
    film.add(0, 0, 0, Xyz{1, 1, 1}, 1);
    const auto image = film.resolve(rgb::ap0.fromXyz(), 2);
    // SMPTE ST 2065-1: rows of XYZ to AP0.
    CHECK(image.r[0] == doctest::Approx(2 * (1.0498110175 - 0.0000974845)).epsilon(1e-6));
    CHECK(image.g[0] == doctest::Approx(2 * (-0.4959030231 + 1.3733130458 + 0.0982400361)).epsilon(1e-6));
    CHECK(image.b[0] == doctest::Approx(2 * 0.9912520182).epsilon(1e-6));
    CHECK(image.variance.empty());

    PixelFilm red({0, 0, 1, 1}, box(), 1);
    red.add(0, 0, 0, Xyz{1, 0.2, 0}, 1);
    CHECK(red.resolve(rgb::ap0.fromXyz(), 1).g[0] < -0.2);
}

TEST_CASE("the image does not depend on threads or on the order of pixels") {
    constexpr int kWidth = 37, kHeight = 29, kReplicates = 2;
    const auto value = [](int x, int y, int r, int pass) {
        return Xyz{std::sin(x + 1.1 * y + r), std::cos(0.3 * x * y + pass), 1.0 / (1 + x + y + pass)};
    };
    PixelFilm forward({0, 0, kWidth, kHeight}, box(), kReplicates),
        parallel({0, 0, kWidth, kHeight}, box(), kReplicates);
    for (int pass = 0; pass < 3; ++pass) {
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x)
                for (int r = 0; r < kReplicates; ++r) forward.add(x, y, r, value(x, y, r, pass), 5);
        parallelFor(kWidth * kHeight, [&](std::size_t i) {
            const int index = kWidth * kHeight - 1 - static_cast<int>(i);
            const int x = index % kWidth, y = index / kWidth;
            for (int r = kReplicates - 1; r >= 0; --r) parallel.add(x, y, r, value(x, y, r, pass), 5);
        });
    }
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            CHECK(forward.mean(x, y).x == parallel.mean(x, y).x);
            CHECK(forward.mean(x, y).z == parallel.mean(x, y).z);
        }
    CHECK(forward.relativeNoise() == parallel.relativeNoise());
}

TEST_CASE("Student's factors") {
    CHECK(studentFactor95(1) == doctest::Approx(12.706).epsilon(1e-4));
    CHECK(studentFactor95(7) == doctest::Approx(2.365).epsilon(1e-3));
    CHECK(studentFactor95(11) == doctest::Approx(2.20099).epsilon(1e-4));
    CHECK(studentFactor95(30) == doctest::Approx(2.04227).epsilon(1e-5));
    CHECK(studentFactor95(1000) == doctest::Approx(1.96234).epsilon(1e-5));
}
