#include "math/warp.h"
#include "support/chi_square.h"
#include "support/jacobian.h"
#include "support/statistics.h"

#include <doctest/doctest.h>
#include <vector>

using namespace abbe;
using namespace abbe::test;

namespace {

// Inside of the unit square, off the seams that the warps have at its diagonals and middle.
Vec2 interior(Random& random) {
    for (;;) {
        const Vec2 u{0.01f + 0.98f * random.uniform(), 0.01f + 0.98f * random.uniform()};
        const float a = 2 * u.x - 1, b = 2 * u.y - 1;
        if (std::abs(std::abs(a) - std::abs(b)) > 0.02f && std::abs(u.x - u.y) > 0.02f) return u;
    }
}

template <typename Map, typename Pdf> double worstJacobian(Map&& map, Pdf&& pdf) {
    Random random(1);
    double worst = 0;
    for (int i = 0; i < 1000; ++i) {
        const Vec2 u = interior(random);
        const auto area = jacobian([&](Vec2 v) -> std::optional<Vec3> { return map(v); }, u, 1e-3f);
        worst = std::max(worst, std::abs(*area * static_cast<double>(pdf(map(u))) - 1));
    }
    return worst;
}

template <typename Map, typename Inverse> float worstRoundTrip(Map&& map, Inverse&& inverse) {
    Random random(2);
    float worst = 0;
    for (int i = 0; i < 10000; ++i) {
        const Vec2 u{random.uniform(), random.uniform()};
        const Vec2 v = inverse(map(u));
        worst = std::max({worst, std::abs(u.x - v.x), std::abs(u.y - v.y)});
    }
    return worst;
}

} // namespace

TEST_CASE("warps: sine and cosine by polynomials") {
    for (int i = -1000; i <= 1000; ++i) {
        const float x = kPi / 4 * static_cast<float>(i) / 1000;
        const SinCos s = sinCosEighth(x);
        CHECK(std::abs(s.sin - std::sin(x)) < 4e-7f);
        CHECK(std::abs(s.cos - std::cos(x)) < 4e-7f);
    }
}

TEST_CASE("warps: disk") {
    const auto lifted = [](Vec2 u) {
        const Vec2 d = squareToDisk(u);
        return Vec3(d.x, d.y, 0);
    };
    CHECK(worstJacobian(lifted, [](Vec3) { return kDiskPdf; }) < 2e-3);
    CHECK(worstRoundTrip(squareToDisk, diskToSquare) < 1e-5f);
    for (Vec2 u : {Vec2{0, 0}, Vec2{0.5f, 0.5f}, Vec2{kOneMinusEpsilon, 0}, Vec2{0, 0.5f}, Vec2{0.5f, 0}}) {
        const Vec2 d = squareToDisk(u);
        CHECK(d.x * d.x + d.y * d.y <= 1.000001f);
        const Vec2 v = diskToSquare(d);
        CHECK(std::abs(u.x - v.x) + std::abs(u.y - v.y) < 1e-5f);
    }
}

TEST_CASE("warps: hemisphere by the cosine") {
    CHECK(worstJacobian(squareToCosineHemisphere, [](Vec3 w) { return cosineHemispherePdf(w.z); }) < 5e-3);
    CHECK(worstRoundTrip(squareToCosineHemisphere, cosineHemisphereToSquare) < 1e-5f);
    CHECK(cosineHemispherePdf(-0.1f) == 0);
    Random random(3);
    Moments z;
    for (int i = 0; i < 100000; ++i)
        z.add(static_cast<double>(squareToCosineHemisphere({random.uniform(), random.uniform()}).z));
    CHECK(meanTest(z, 2.0 / 3) > 1e-4);
}

TEST_CASE("warps: sphere") {
    CHECK(worstJacobian(squareToSphere, [](Vec3) { return kSpherePdf; }) < 2e-3);
    CHECK(worstRoundTrip(squareToSphere, sphereToSquare) < 2e-4f); // longitude near the poles
}

TEST_CASE("warps: cone") {
    for (float halfAngle : {1e-3f, 0.1f, 1.f, 1.57f}) {
        const float h = oneMinusCos(std::sin(halfAngle));
        CHECK(static_cast<double>(h) ==
              doctest::Approx(2 * square(std::sin(static_cast<double>(halfAngle) / 2)))
                  .epsilon(halfAngle > 1.5f ? 5e-5 : 2e-6)); // the sine of a right angle tells little
        // Magnified, so that small cones keep their digits in the differences.
        const float k = 1 / std::sin(halfAngle);
        const auto map = [&](Vec2 u) { return multiply(squareToCone(u, h), Vec3(k, k, k)); };
        CHECK(worstJacobian(map, [&](Vec3) { return conePdf(h) / (k * k); }) < 1e-2);
        Random random(4);
        for (int i = 0; i < 1000; ++i) {
            const Vec3 w = squareToCone({random.uniform(), random.uniform()}, h);
            CHECK(length(w) == doctest::Approx(1).epsilon(1e-6));
            CHECK(std::hypot(w.x, w.y) <= std::sin(halfAngle) * 1.00001f);
        }
    }
    // docs/hard_cases.md, case 30.
    CHECK(oneMinusCos(1e-7f) == doctest::Approx(5e-15).epsilon(1e-5));
    CHECK(oneMinusCos(0) == 0);
    CHECK(oneMinusCos(1) == 1);
}

TEST_CASE("warps: triangle") {
    const auto lifted = [](Vec2 u) {
        const Vec2 b = squareToTriangle(u);
        return Vec3(b.x, b.y, 0);
    };
    CHECK(worstJacobian(lifted, [](Vec3) { return 2.f; }) < 2e-3);
    Random random(5);
    std::vector<double> observed(36, 0.0), expected(36, 0.0);
    constexpr int n = 100000;
    for (int i = 0; i < n; ++i) {
        const Vec2 b = squareToTriangle({random.uniform(), random.uniform()});
        REQUIRE(b.x >= 0);
        REQUIRE(b.y >= 0);
        REQUIRE(b.x + b.y <= 1.000001f);
        const int x = std::min(5, static_cast<int>(b.x * 6)), y = std::min(5, static_cast<int>(b.y * 6));
        ++observed[static_cast<std::size_t>(6 * y + x)];
    }
    for (int y = 0; y < 6; ++y)
        for (int x = 0; x + y < 6; ++x) expected[static_cast<std::size_t>(6 * y + x)] = n * (x + y < 5 ? 2 : 1) / 36.0;
    CHECK(chiSquareTest(observed, expected).pValue > 1e-4);
}

namespace abbe::test {

TEST_CASE("equiangular distances have the density that they state") {
    const struct {
        Vec3 point;
        float tNear, tFar;
    } cases[] = {{{0.3f, 2, 0}, 0, 5},
                 {{3, 0.01f, 0}, 1, 4},
                 {{-2, 1, 0}, 0, kInfinity},
                 {{2, 0, 0}, 0, 10},
                 {{1e4f, 3, 1}, 0, kInfinity}};
    for (const auto& c : cases) {
        const EquiangularDistances d({0, 0, 0}, {1, 0, 0}, c.point, c.tNear, c.tFar);
        REQUIRE(d.valid());
        // u as the distribution function of t: its slope is the density.
        for (int i = 1; i < 200; ++i) {
            const float u = static_cast<float>(i) / 200, step = 1.f / 4096;
            const float a = d.sample(u - step), b = d.sample(u + step);
            CAPTURE(u);
            CHECK((a >= c.tNear && b <= c.tFar && a <= b));
            if (!(b < 1e3f * length(c.point))) continue;
            // Simpson's rule between the two.
            const double mass =
                static_cast<double>(b - a) / 6 * static_cast<double>(d.pdf(a) + 4 * d.pdf(0.5f * (a + b)) + d.pdf(b));
            CHECK(mass == doctest::Approx(static_cast<double>(2 * step)).epsilon(0.05));
        }
        CHECK(d.pdf(c.tNear - 1) == 0);
    }
}

TEST_CASE("no distances where a range has no width") {
    CHECK_FALSE(EquiangularDistances({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, 2, 2).valid());
    CHECK_FALSE(EquiangularDistances({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, 3, 2).valid());
}

} // namespace abbe::test
