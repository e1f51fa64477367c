// Cones of directions to balls, from as far as it takes for them to look like points.
#include "caustics/shared/aim_cone.h"
#include "support/statistics.h"

#include <cmath>
#include <doctest/doctest.h>

namespace abbe {

// Hard case 30. The cone is wider than the ball by a few steps of a float: sin θ by 2⁻²².
TEST_CASE("aim cone: its density is that of its solid angle, at any distance") {
    for (const double sine : {0.999, 0.5, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-9}) {
        CAPTURE(sine);
        const auto radius = static_cast<float>(sine * 3);
        const auto cone = AimCone::seen({{1, 2, 5}, radius}, {1, 2, 2});
        REQUIRE(cone);
        const long double s = static_cast<long double>(radius) / 3 + 0x1p-22L;
        const long double half = std::sin(std::asin(s) / 2); // 1 - cos θ = 2 sin² θ/2
        CHECK(cone->pdf() ==
              doctest::Approx(static_cast<double>(1 / (4 * 3.14159265358979323846L * half * half))).epsilon(1e-9));
    }
}

TEST_CASE("aim cone: directions stay within it, fill it evenly and point at the ball") {
    test::Random random(2);
    for (const float distance : {1.001f, 1.5f, 10.f, 1e3f, 1e5f, 1e6f}) {
        CAPTURE(distance);
        const Vec3 axis = normalize(Vec3{-1, 3, 0.5f}), from = axis * -distance;
        const auto cone = AimCone::seen({{0, 0, 0}, 1}, from);
        REQUIRE(cone);
        test::Moments height; // of 1 - cos θ over its largest: even
        int outside = 0, missed = 0;
        constexpr int samples = 20000;
        const double largest = 1 / (2 * kPiD * cone->pdf());
        const Vec3d middle = normalize(-Vec3d(from));
        for (int i = 0; i < samples; ++i) {
            const Vec3 w = cone->sample({random.uniform(), random.uniform()});
            outside += !cone->contains(w);
            const Vec3d across = cross(Vec3d(w), middle);
            const double sin2 = dot(across, across) / dot(Vec3d(w), Vec3d(w));
            height.add(sin2 / (1 + std::sqrt(std::max(0.0, 1 - sin2))) / largest);
            missed += std::sqrt(sin2) * static_cast<double>(distance) > 1;
        }
        CAPTURE(height.mean());
        const double steps = 0x1p-22 * static_cast<double>(distance);      // by how much of the ball it is too wide
        CHECK(test::meanTest(height, 0.5) > (distance < 1e5f ? 1e-4 : 0)); // beyond, directions are a coarse grid
        CHECK(height.mean() == doctest::Approx(0.5).epsilon(0.03));
        CHECK(outside <= samples * 0.05 * std::min(1.0, steps + 0.001));
        CHECK(missed <= samples * (2.5 * steps + 0.001));
    }
}

TEST_CASE("aim cone: the number that makes a direction, and the direction") {
    test::Random random(3);
    for (const float distance : {1.001f, 1.5f, 30.f, 1e3f, 4e3f}) {
        CAPTURE(distance);
        const Vec3 axis = normalize(Vec3{-1, 3, 0.5f});
        const auto cone = AimCone::seen({{0, 0, 0}, 1}, axis * -distance);
        REQUIRE(cone);
        REQUIRE(cone->resolves());
        float worst = 0;
        for (int i = 0; i < 10000; ++i) {
            const Vec2 u{random.uniform(), random.uniform()}, back = cone->square(cone->sample(u));
            worst = std::max({worst, std::abs(back.x - u.x), std::abs(back.y - u.y)});
        }
        CHECK(worst < 1e-5f + 4e-7f * distance);
    }
    CHECK(!AimCone::seen({{0, 0, 0}, 1}, {0, 0, 1e5f})->resolves());
}

TEST_CASE("aim cone: what passes by quickly is outside, and most of what is outside passes by quickly") {
    test::Random random(4);
    const auto around = [&random](float size) {
        return Vec3{random.uniform() - 0.5f, random.uniform() - 0.5f, random.uniform() - 0.5f} * size;
    };
    int outside = 0, quick = 0;
    for (int i = 0; i < 100000; ++i) {
        const Vec3 from = around(4);
        const AimTarget target{around(4), std::pow(10.f, 1 - 8 * random.uniform())};
        const auto cone = AimCone::seen(target, from);
        // About the ball, or right at the edge of it.
        const Vec3 w =
            normalize(i % 2 || !cone ? around(1) : cone->sample({kOneMinusEpsilon, random.uniform()}) + around(1e-7f));
        const bool passes = AimCone::passes(target, from, w);
        if (passes) CHECK((cone && !cone->contains(w)));
        const double least = random.uniformDouble();
        if (AimCone::passes(target, from, w, least)) CHECK(AimCone::seen(target, from, least));
        if (i % 2 && cone && !cone->contains(w)) {
            ++outside;
            quick += passes;
        }
    }
    CHECK(outside > 30000);
    CHECK(quick > 0.99 * outside);
}

TEST_CASE("aim cone: none from inside of the ball, on it or at its centre; a half of all directions just outside") {
    const AimTarget ball{{0, 0, 0}, 2};
    CHECK_FALSE(AimCone::seen(ball, {0, 0, 0}));
    CHECK_FALSE(AimCone::seen(ball, {0, 1, 0}));
    CHECK_FALSE(AimCone::seen(ball, {0, 2, 0}));
    const auto near = AimCone::seen(ball, {0, 2.00001f, 0});
    REQUIRE(near);
    CHECK(near->pdf() == doctest::Approx(1 / (2 * kPiD)).epsilon(0.01));
    CHECK(near->contains({0, -1, 0}));
    CHECK_FALSE(near->contains({0, 1, 0}));
}

} // namespace abbe
