#include "math/transform.h"

#include <doctest/doctest.h>

using namespace abbe;

namespace {

void checkNear(Vec3d a, Vec3d b, double tolerance = 1e-12) {
    CAPTURE(a.x);
    CAPTURE(a.y);
    CAPTURE(a.z);
    CHECK(length(a - b) <= tolerance);
}

Transform shear() {
    Transform t;
    t.a[0][1] = 0.7;
    t.a[2][0] = -0.2;
    t.t = {1, 2, 3};
    return t;
}

} // namespace

TEST_CASE("transform: elementary maps") {
    checkNear(Transform::translate({1, 2, 3}).point({1, 1, 1}), {2, 3, 4});
    checkNear(Transform::translate({1, 2, 3}).vector({1, 1, 1}), {1, 1, 1});
    checkNear(Transform::scale({2, 3, -1}).point({1, 1, 1}), {2, 3, -1});
    // Right-handed: x turns to y about z, y to z about x, z to x about y.
    checkNear(Transform::rotate({0, 0, 5}, kPiD / 2).point({1, 0, 0}), {0, 1, 0});
    checkNear(Transform::rotate({1, 0, 0}, kPiD / 2).point({0, 1, 0}), {0, 0, 1});
    checkNear(Transform::rotate({0, 1, 0}, kPiD / 2).point({0, 0, 1}), {1, 0, 0});
    checkNear(Transform::rotate({1, 1, 1}, 2 * kPiD / 3).point({1, 2, 3}), {3, 1, 2});
}

TEST_CASE("transform: then applies this first") {
    const Transform t = Transform::scale({2, 2, 2}).then(Transform::translate({1, 0, 0}));
    checkNear(t.point({1, 1, 1}), {3, 2, 2});
    const Transform u = Transform::translate({1, 0, 0}).then(Transform::scale({2, 2, 2}));
    checkNear(u.point({1, 1, 1}), {4, 2, 2});
}

TEST_CASE("transform: the inverse undoes") {
    for (const Transform& t : {Transform{}, shear(), Transform::rotate({1, 2, 3}, 0.7).then(shear()),
                               Transform::scale({-1e-6, 2, 1e6}).then(Transform::translate({5, 6, 7}))}) {
        const auto inverse = t.inverse();
        REQUIRE(inverse);
        for (Vec3d p : {Vec3d(0, 0, 0), Vec3d(1, -2, 3), Vec3d(100, 20, -3)}) {
            checkNear(inverse->point(t.point(p)), p, 1e-8);
            checkNear(t.point(inverse->point(p)), p, 1e-8);
        }
        CHECK(t.determinant() * inverse->determinant() == doctest::Approx(1));
    }
}

TEST_CASE("transform: determinants") {
    CHECK(Transform{}.determinant() == 1);
    CHECK(Transform::scale({2, 3, -4}).determinant() == -24);
    CHECK(Transform::rotate({1, 2, 3}, 1).determinant() == doctest::Approx(1));
    CHECK(shear().then(Transform::scale({2, 2, 2})).determinant() == doctest::Approx(8));
}

TEST_CASE("transform: normals stay perpendicular and outward") {
    for (const Transform& t : {Transform{}, shear(), Transform::scale({-1, 1, 1}), Transform::scale({1, -2, 0.3}),
                               Transform::rotate({1, 2, 3}, 0.7).then(shear()).then(Transform::scale({-2, -3, -4})),
                               Transform::scale({1e-5, 1e-5, -1e-5}), Transform::scale({1e5, 2e5, 3e5})}) {
        // A plane through p with normal n; `out` lies outside of it.
        const Vec3d n = normalize(Vec3d(1, 2, -0.5)), out = normalize(Vec3d(2, 1, 0));
        const Vec3d a = normalize(cross(n, Vec3d(1, 0, 0))), b = cross(n, a);
        REQUIRE(dot(out, n) > 0);
        const Vec3d m = t.normal(n);
        CHECK(std::abs(dot(normalize(m), normalize(t.vector(a)))) < 1e-12);
        CHECK(std::abs(dot(normalize(m), normalize(t.vector(b)))) < 1e-12);
        CHECK(dot(m, t.vector(out)) > 0);
        // Its length is the ratio of areas.
        CHECK(length(m) == doctest::Approx(length(cross(t.vector(a), t.vector(b)))));
    }
}

TEST_CASE("transform: uniform scales") {
    CHECK(*Transform{}.uniformScale() == doctest::Approx(1));
    CHECK(*Transform::scale({-3, 3, 3}).then(Transform::rotate({1, 2, 3}, 1)).uniformScale() == doctest::Approx(3));
    CHECK_FALSE(Transform::scale({1, 1, 1.001}).uniformScale());
    CHECK_FALSE(shear().uniformScale());
}

TEST_CASE("transform: lookAt puts -z towards the target and y near up") {
    const auto t = Transform::lookAt({1, 2, 3}, {4, 5, 6}, {0, 1, 0});
    REQUIRE(t);
    checkNear(t->point({0, 0, 0}), {1, 2, 3});
    checkNear(t->vector({0, 0, -1}), normalize(Vec3d(1, 1, 1)));
    CHECK(t->vector({0, 1, 0}).y > 0);
    CHECK(std::abs(t->vector({1, 0, 0}).y) < 1e-12);
    CHECK(t->determinant() == doctest::Approx(1));
    CHECK_FALSE(Transform::lookAt({1, 2, 3}, {1, 2, 3}, {0, 1, 0}));
    CHECK_FALSE(Transform::lookAt({0, 0, 0}, {0, 5, 0}, {0, 1, 0}));
    CHECK_FALSE(Transform::lookAt({0, 0, 0}, {0, 0, 1}, {0, 0, 0}));
}

TEST_CASE("transform: not finite") {
    Transform t;
    CHECK(t.isFinite());
    t.t.y = std::numeric_limits<double>::infinity();
    CHECK_FALSE(t.isFinite());
    CHECK_FALSE(Transform::scale({1e308, 1e308, 1e308}).inverse());
}
