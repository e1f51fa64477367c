// The opening of a lens: uniform, of the right area and the right form.
#include "cameras/exposure.h"
#include "support/chi_square.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

// Samples against the share of every cell of a grid that contains() claims.
double pValue(const Aperture& aperture, std::uint64_t seed) {
    constexpr int kGrid = 24, kFine = 24, kSamples = 200'000;
    const double size = 2 * aperture.outerRadius() / kGrid, fine = size / kFine;
    std::vector<double> observed(kGrid * kGrid), expected(kGrid * kGrid);
    double inside = 0;
    for (int j = 0; j < kGrid * kFine; ++j)
        for (int i = 0; i < kGrid * kFine; ++i) {
            const Vec2d p{(i + 0.5) * fine - aperture.outerRadius(), (j + 0.5) * fine - aperture.outerRadius()};
            if (!aperture.contains(p)) continue;
            ++expected[static_cast<std::size_t>(j / kFine * kGrid + i / kFine)];
            ++inside;
        }
    const double area = inside * fine * fine;
    CHECK(area == doctest::Approx(kPiD * aperture.radius() * aperture.radius()).epsilon(2e-3).scale(0));
    for (double& e : expected) e *= kSamples / inside;
    test::Random random(seed);
    for (int i = 0; i < kSamples; ++i) {
        const Vec2 p = aperture.sample({random.uniform(), random.uniform()});
        const auto cell = [&](float x) {
            return std::clamp(static_cast<int>((static_cast<double>(x) + aperture.outerRadius()) / size), 0, kGrid - 1);
        };
        ++observed[static_cast<std::size_t>(cell(p.y) * kGrid + cell(p.x))];
    }
    // Cells that the edge just touches: the grid of points cannot tell a small share from none.
    std::vector<double> sureObserved, sureExpected;
    for (std::size_t i = 0; i < observed.size(); ++i)
        if (expected[i] > 20) {
            sureObserved.push_back(observed[i]);
            sureExpected.push_back(expected[i]);
        }
    return test::chiSquareTest(sureObserved, sureExpected).pValue;
}

TEST_CASE("samples are uniform over the opening, whatever its form") {
    CHECK(pValue(Aperture(0.01), 1) > 1e-3);
    CHECK(pValue(Aperture(0.01, 3, 0, 0), 2) > 1e-3);
    CHECK(pValue(Aperture(0.01, 5, 10 * kDegree, 0), 3) > 1e-3);
    CHECK(pValue(Aperture(0.01, 6, 0, 0.5), 4) > 1e-3);
    CHECK(pValue(Aperture(0.01, 9, 12 * kDegree, 0.25), 5) > 1e-3);
    CHECK(pValue(Aperture(0.01, 7, 0, 1), 6) > 1e-3);
}

TEST_CASE("no sample lies outside") {
    test::Random random(7);
    for (const double roundness : {0.0, 0.3, 1.0}) {
        const Aperture aperture(1, 5, 0.3, roundness);
        for (int i = 0; i < 20'000; ++i) {
            const Vec2 p = aperture.sample({random.uniform(), random.uniform()});
            REQUIRE(aperture.contains(Vec2d{static_cast<double>(p.x), static_cast<double>(p.y)} * (1 - 1e-6)));
        }
        for (const Vec2 u : {Vec2{0, 0}, {kOneMinusEpsilon, kOneMinusEpsilon}, {0, kOneMinusEpsilon}})
            CHECK(std::isfinite(aperture.sample(u).x));
    }
}

TEST_CASE("a corner is upright, and turns counter-clockwise") {
    const auto corner = [](const Aperture& a, double degrees) {
        const double r = a.outerRadius() * 0.999;
        return a.contains({r * std::cos(degrees * kDegree), r * std::sin(degrees * kDegree)});
    };
    const Aperture upright(1, 5, 0, 0), turned(1, 5, 12 * kDegree, 0);
    CHECK(corner(upright, 90));
    CHECK(corner(upright, 90 + 72));
    CHECK_FALSE(corner(upright, 90 + 36));
    CHECK_FALSE(corner(upright, 102));
    CHECK(corner(turned, 102));
    // A regular polygon of n corners and area π has the circumradius √(2π / (n sin(2π/n))).
    CHECK(upright.outerRadius() ==
          doctest::Approx(std::sqrt(2 * kPiD / (5 * std::sin(72 * kDegree)))).epsilon(1e-12).scale(0));
    CHECK(Aperture(1, 5, 0, 1).outerRadius() == doctest::Approx(1).epsilon(1e-12).scale(0));
}

} // namespace
} // namespace abbe
