// Rectangles and triangles seen from a point: solid angles, directions into them and back. Densities:
// projected_sampling_test.
#include "geometry/spherical_sampling.h"
#include "support/statistics.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

// The integral of cosine / distance² over the triangle by the midpoint rule.
double solidAngleByQuadrature(Vec3d a, Vec3d b, Vec3d c) {
    const Vec3d s = b - a, t = c - a, n = cross(s, t);
    constexpr int steps = 48;
    double sum = 0;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps - i; ++j)
            for (int half = 0; half < 2; ++half) {
                if (half && j == steps - i - 1) continue;
                const double o = half ? 2.0 / 3 : 1.0 / 3;
                const Vec3d p = a + s * ((i + o) / steps) + t * ((j + o) / steps);
                const double d2 = lengthSquared(p);
                sum += std::abs(dot(p, n)) / (d2 * std::sqrt(d2));
            }
    return sum / (2.0 * steps * steps);
}

Vec3d randomPoint(Random& random) {
    const auto u = [&random] { return static_cast<double>(random.uniform()) - 0.5; };
    return {u(), u(), u()};
}

} // namespace

// docs/hard_cases.md, case 31.
TEST_CASE("spherical triangle: solid angles of any size") {
    Random random(3);
    for (const double size : {1e-6, 1e-3, 1e-2, 0.1, 0.5})
        for (int i = 0; i < 40; ++i) {
            const Vec3d middle(0.3, -0.2, 1.5);
            const Vec3d a = middle + randomPoint(random) * size, b = middle + randomPoint(random) * size,
                        c = middle + randomPoint(random) * size;
            const double expected = solidAngleByQuadrature(a, b, c);
            // A sliver seen edge-on has none to speak of.
            if (expected < 1e-3 * size * size) continue;
            CHECK(SphericalTriangle(a, b, c).solidAngle() == doctest::Approx(expected).epsilon(1e-3));
        }
    CHECK(SphericalTriangle({1, 0, 0}, {0, 1, 0}, {0, 0, 1}).solidAngle() == doctest::Approx(kPiD / 2));
    CHECK(SphericalTriangle({3, 0, 0}, {0, 0.1, 0}, {0, 0, 20}).solidAngle() == doctest::Approx(kPiD / 2));
    // Around a point just below it: almost a hemisphere.
    CHECK(SphericalTriangle({1, 0, 1e-4}, {-0.5, 0.9, 1e-4}, {-0.5, -0.9, 1e-4}).solidAngle() ==
          doctest::Approx(2 * kPiD).epsilon(1e-3));
}

TEST_CASE("spherical triangle: directions are inside, the whole square's, and lead back") {
    Random random(5);
    for (int i = 0; i < 200; ++i) {
        const double size = std::pow(10.0, -1.5 * static_cast<double>(random.uniform()));
        const Vec3d middle(0.2, 0.3, 0.6);
        const Vec3d a = middle + randomPoint(random) * size, b = middle + randomPoint(random) * size,
                    c = middle + randomPoint(random) * size;
        const SphericalTriangle triangle(a, b, c);
        if (triangle.solidAngle() < 3e-4) continue;
        CHECK(length(triangle.direction({0, 1}) - normalize(a)) < 1e-6);
        CHECK(length(triangle.direction({0.5f, 0}) - normalize(b)) < 1e-6);
        CHECK(length(triangle.direction({1, 1}) - normalize(c)) < 1e-6);
        const double turn = dot(a, cross(b, c)) < 0 ? -1 : 1;
        for (int k = 0; k < 20; ++k) {
            const Vec2 u{random.uniform(), random.uniform()};
            const Vec3d w = triangle.direction(u);
            CHECK_UNARY(std::abs(length(w) - 1) < 1e-9);
            for (const auto& [p, q] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
                CHECK_UNARY(turn * dot(cross(normalize(p), normalize(q)), w) > -1e-9);
            const Vec2 back = triangle.inverse(w);
            CHECK_UNARY((std::abs(back.x - u.x) < 1e-4f && std::abs(back.y - u.y) < 1e-4f));
        }
    }
}

// docs/hard_cases.md, case 32.
TEST_CASE("near polygon: far, tiny, edge-on and touched triangles are left to sampling per area") {
    const auto seen = [](Vec3 from, Vec3 c = {0, 2, 1}) {
        const NearPolygon::Corners t{Vec3{-1, 2, -1}, Vec3{1, 2, -1}, c};
        return NearPolygon::seen({&t, 1}, from).has_value();
    };
    CHECK(seen({0, 0, 0}));
    CHECK_FALSE(seen({0, -6, 0}));                   // far
    CHECK_FALSE(seen({0.5f, 2, 3}));                 // in its plane
    CHECK_FALSE(seen({0, 2, 0}));                    // on it
    CHECK_FALSE(seen({1, 2, -1}));                   // at a corner
    CHECK_FALSE(seen({0, 0, 0}, {0, 2, -0.99999f})); // a sliver
    CHECK_FALSE(seen({0, 0, 0}, {1, 2, -1}));        // a line
}

} // namespace abbe::test

using namespace abbe;
using test::Random;

namespace {

// By the corners: exact for rectangles of any size, in double.
double solidAngle(double x0, double y0, double x1, double y1, double z) {
    const auto corner = [z](double x, double y) { return std::atan(x * y / (z * std::sqrt(x * x + y * y + z * z))); };
    return corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0);
}

} // namespace

TEST_CASE("spherical rectangle: solid angle against the exact one") {
    Random random(1);
    for (int i = 0; i < 100000; ++i) {
        const float x = 4 * random.uniform() - 2, y = 4 * random.uniform() - 2;
        const float w = 2 * random.uniform() + 0.01f, h = 2 * random.uniform() + 0.01f;
        const float z = std::pow(10.f, 2 - 6 * random.uniform());
        const SphericalRectangle r(x, y, x + w, y + h, i & 1 ? z : -z);
        const double x1 = static_cast<double>(x + w), y1 = static_cast<double>(y + h);
        REQUIRE(std::abs(static_cast<double>(r.solidAngle()) -
                         solidAngle(static_cast<double>(x), static_cast<double>(y), x1, y1, static_cast<double>(z))) <
                1.2e-6);
    }
    CHECK(SphericalRectangle(-1, -1, 1, 1, 0).solidAngle() == 0);
    CHECK(SphericalRectangle(-1, -1, 1, 1, 1).solidAngle() == doctest::Approx(4 * kPiD / 6).epsilon(1e-6));
    CHECK(SphericalRectangle(-1, -1, 1, 1, 1e-30f).solidAngle() == doctest::Approx(2 * kPiD).epsilon(1e-6));
}

TEST_CASE("spherical rectangle: shares of the solid angle come out as the numbers that went in") {
    // The map takes u.x to the part of the rectangle left of x that holds this share of the solid angle.
    Random random(2);
    for (int i = 0; i < 20000; ++i) {
        const float x = 4 * random.uniform() - 2, y = 4 * random.uniform() - 2;
        const float w = 2 * random.uniform() + 0.1f, h = 2 * random.uniform() + 0.1f;
        const float z = 0.05f + random.uniform();
        const SphericalRectangle r(x, y, x + w, y + h, z);
        if (r.solidAngle() < 5e-3f) continue;
        const Vec2 u{random.uniform(), random.uniform()};
        const Vec2 q = r.sample(u);
        REQUIRE(q.x >= x);
        REQUIRE(q.x <= x + w);
        REQUIRE(q.y >= y);
        REQUIRE(q.y <= y + h);
        const auto d = [](float v) { return static_cast<double>(v); };
        const double left = solidAngle(d(x), d(y), d(q.x), d(y + h), d(z));
        REQUIRE(std::abs(left - d(u.x) * d(r.solidAngle())) < 1e-5);
        // Along a line of constant x the solid angle grows with y / sqrt(x² + y² + z²).
        const auto height = [&](double v) { return v / std::sqrt(d(q.x) * d(q.x) + v * v + d(z) * d(z)); };
        const double share = (height(d(q.y)) - height(d(y))) / (height(d(y + h)) - height(d(y)));
        REQUIRE(std::abs(share - d(u.y)) < 1e-3);
    }
}
