#include "geometry/spherical_rectangle.h"
#include "support/statistics.h"

#include <doctest/doctest.h>

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
