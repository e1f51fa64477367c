// Piecewise-constant distributions: probabilities, the ends of the unit interval, and great ranges of weight.
#include "math/distribution.h"
#include "support/chi_square.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

TEST_CASE("bins are drawn in proportion to their weights") {
    const std::vector<double> weights = {3, 0, 1, 0.5, 2, 0, 0, 1};
    const Distribution1D d(weights);
    CHECK(d.total() == doctest::Approx(7.5));
    constexpr int n = 200000;
    std::vector<double> observed(weights.size()), expected;
    for (double w : weights) expected.push_back(w / 7.5 * n);
    test::Random random(1);
    for (int i = 0; i < n; ++i) {
        const BinSample s = d.sample(random.uniform());
        ++observed[s.index];
        CHECK(s.probability == d.probability(s.index));
    }
    CHECK(test::chiSquareTest(observed, expected).pValue > 1e-4);
}

// Hard case 36.
TEST_CASE("a bin of weight 0 is never drawn, whatever the random number") {
    const std::vector<std::vector<double>> cases = {
        {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {0, 1e-30, 0, 1e30, 0}, {1e-320, 0, 0}, std::vector<double>(1000, 0.1)};
    for (auto weights : cases) {
        weights.push_back(0);
        const Distribution1D d(weights);
        const auto check = [&](float u) {
            const BinSample s = d.sample(u);
            if (!(weights[s.index] > 0 && s.probability > 0 && s.offset >= 0 && s.offset < 1)) FAIL("u = ", u);
        };
        for (float u : {0.f, 0x1p-149f, 0x1p-24f, 0.5f, 0x1.fffffcp-1f, kOneMinusEpsilon}) check(u);
        for (std::uint32_t i = 0; i < 1u << 24; i += 97) check(static_cast<float>(i) * 0x1p-24f);
    }
}

TEST_CASE("the part of the random number that is left is uniform within the bin") {
    const Distribution1D d(std::vector<double>{1, 5, 2});
    test::Random random(2);
    std::vector<double> left;
    for (int i = 0; i < 20000; ++i) left.push_back(d.sample(random.uniform()).offset);
    CHECK(test::kolmogorovUniform(left) > 1e-4);
}

TEST_CASE("points have their density, and their inverse") {
    const Distribution1D d(std::vector<double>{1, 0, 3, 2});
    double integral = 0;
    for (int i = 0; i < 4000; ++i) integral += d.pdf((static_cast<float>(i) + 0.5f) / 4000) / 4000;
    CHECK(integral == doctest::Approx(1).epsilon(1e-6));
    for (int i = 0; i < 1000; ++i) {
        const float u = (static_cast<float>(i) + 0.5f) / 1000;
        const Distribution1D::Point p = d.samplePoint(u);
        CHECK(p.pdf == doctest::Approx(d.pdf(p.x)));
        CHECK(d.inverse(p.x) == doctest::Approx(u).epsilon(1e-5));
    }
}

// Hard case 34: a float table would round the dark bins away.
TEST_CASE("dark bins keep their probability beside one that is a thousand million times brighter") {
    std::vector<double> weights(100000, 1);
    weights[10] = 1e9;
    const Distribution1D d(weights);
    const double expected = 1 / (1e9 + 99999);
    for (std::size_t i : {std::size_t{0}, std::size_t{11}, std::size_t{50000}, std::size_t{99999}})
        CHECK(d.probability(i) == doctest::Approx(expected).epsilon(1e-5));
}

TEST_CASE("no weight at all: uniform, and the total says so") {
    const Distribution1D d(std::vector<double>(4, 0.0));
    CHECK(d.total() == 0);
    CHECK(d.probability(3) == 0.25);
    CHECK(d.sample(kOneMinusEpsilon).index == 3);
}

TEST_CASE("cells of a grid are drawn in proportion to their weights") {
    const std::vector<double> weights = {1, 2, 0, 0, 0, 0, 0, 3, 4};
    const Distribution2D d(weights, 3);
    CHECK(d.rows() == 3);
    CHECK(d.total() == doctest::Approx(10));
    constexpr int n = 200000;
    std::vector<double> observed(9), expected, probabilities;
    for (std::size_t i = 0; i < 9; ++i) {
        expected.push_back(weights[i] / 10 * n);
        CHECK(d.probability(i % 3, i / 3) == doctest::Approx(weights[i] / 10).epsilon(1e-12));
    }
    test::Random random(3);
    for (int i = 0; i < n; ++i) {
        const CellSample s = d.sample({random.uniform(), random.uniform()});
        CHECK(s.probability == doctest::Approx(d.probability(s.column, s.row)).epsilon(1e-12));
        ++observed[s.row * 3 + s.column];
    }
    CHECK(test::chiSquareTest(observed, expected).pValue > 1e-4);
}

} // namespace
} // namespace abbe
