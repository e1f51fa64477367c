#include "io/tile_test.h"

#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <random>
#include <vector>

using namespace abbe;

namespace {

constexpr int kTestedWidth = 256, kTestedHeight = 192;
constexpr double kFloat = 0x1p-22;

// A rendered image: the mean and the variance of the mean of R replicates, whose distribution and noise vary over it.
struct Render {
    std::vector<float> values, variances;
    int replicates;

    Render(unsigned seed, int r, double bias = 1, bool skewed = false) : replicates(r) {
        std::mt19937 random(seed);
        std::normal_distribution<double> normal;
        for (int i = 0; i < kTestedWidth * kTestedHeight; ++i) {
            const double level = 0.2 + (i % kTestedWidth) / 300.0,
                         sigma = 0.05 + 0.2 * (i / kTestedWidth) / kTestedHeight;
            double sum = 0, squares = 0;
            for (int k = 0; k < r; ++k) {
                const double z = normal(random);
                const double x = level * bias * (1 + sigma * (skewed ? (std::exp(z) - std::exp(0.5)) / 2.1612 : z));
                sum += x;
                squares += x * x;
            }
            values.push_back(static_cast<float>(sum / r));
            variances.push_back(static_cast<float>(std::max(0.0, squares - sum * sum / r) / (r - 1) / r));
        }
    }
    NoisyPlane plane() const { return {values, variances, replicates, kFloat}; }
};

TileTest tested(const Render& a, const Render& b) {
    return tileTest(a.plane(), b.plane(), kTestedWidth, kTestedHeight);
}

} // namespace

TEST_CASE("scores of images that agree are normal") {
    for (const int replicates : {2, 8}) {
        const TileTest t = tested(Render(1, replicates), Render(2, replicates));
        CHECK(t.tiles == kTestedWidth * kTestedHeight / 64);
        CHECK(std::abs(t.mean) < 0.12);
        CHECK(std::abs(t.deviation - 1) < 0.08); // three standard errors
        CHECK(t.probability() > 0.01);
        CHECK(t.verdict() == "the images agree within their noise");
    }
}

TEST_CASE("a bias of 1 % is found, over the image and in one tile") {
    const TileTest all = tested(Render(3, 4, 1.01), Render(4, 4));
    CHECK(all.probability() < 1e-6);
    CHECK(all.verdict().find("brighter") != std::string::npos);
    CHECK(tested(Render(5, 4, 0.99), Render(6, 4)).verdict().find("darker") != std::string::npos);

    Render local(7, 4);
    for (int y = 40; y < 48; ++y)
        for (int x = 80; x < 88; ++x) local.values[static_cast<std::size_t>(y * kTestedWidth + x)] *= 1.1f;
    const TileTest one = tested(local, Render(8, 4));
    CHECK(one.largestProbability < 0.01);
    CHECK(one.largestX == 80);
    CHECK(one.largestY == 40);
    CHECK(one.verdict().find("(80, 40)") != std::string::npos);
}

TEST_CASE("variances that are wrong, and seeds in common, are found") {
    Render a(9, 4);
    for (float& v : a.variances) v *= 2;
    CHECK(tested(a, Render(10, 4)).kolmogorovProbability < 0.01);
    const Render same(11, 4);
    CHECK(tested(same, same).verdict() == "the images are equal, noise included");
    CHECK(tested(same, same).probability() < 1e-6);
}

TEST_CASE("tiles without noise are compared up to rounding; what is not finite is left out") {
    std::vector<float> values(64 * 4, 0.5f), none(64 * 4, 0.0f), noise(64 * 4, 1e-4f);
    const NoisyPlane exact{values, none, 2, kFloat};
    CHECK(tileTest(exact, exact, 32, 8).noiseless == 4);
    CHECK(tileTest(exact, exact, 32, 8).verdict() == "the images are equal; there is no noise");
    std::vector<float> other = values;
    other[3] = 0.5001f;
    const TileTest t = tileTest(exact, {other, none, 2, kFloat}, 32, 8);
    CHECK(t.unequal == 1);
    CHECK(t.probability() == 0);
    CHECK(tileTest(exact, {other, none, 2, 0x1p-11}, 32, 8).unequal == 0);

    noise[0] = std::numeric_limits<float>::infinity();
    other[9] = std::numeric_limits<float>::quiet_NaN();
    const TileTest s = tileTest({values, noise, 2, kFloat}, {other, noise, 2, kFloat}, 32, 8);
    CHECK(s.skipped == 2);
    CHECK(s.tiles == 2);
    const NoisyPlane unknown{std::span(values).first(64), std::span(noise).first(64), 2, kFloat};
    CHECK(tileTest(unknown, unknown, 8, 8).verdict().find("nothing") == 0);
}
