// Triangles seen from a point: solid angles, directions into them and back. Densities: projected_sampling_test.
#include "geometry/near_polygon.h"
#include "geometry/spherical_triangle.h"
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
