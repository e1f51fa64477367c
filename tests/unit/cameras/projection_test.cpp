// Parallel projection and panoramas.
#include "camera_fixture.h"
#include "cameras/projections.h"

namespace abbe {
namespace {

constexpr double kProjectionDegree = kPiD / 180;

Ray projectionRay(const PlacedCamera& c, Vec2 film) { return c.camera->ray({film, {0.3f, 0.9f}, 0.5f, 550}).ray; }

TEST_CASE("an orthographic picture measures the same everywhere") {
    OrthographicParams p;
    p.from = Vec3d{1, 2, 10};
    p.lookAt = Vec3d{1, 2, 0};
    p.height = 4;
    const PlacedCamera c = test::made(makeOrthographic, p, {600, 400});
    CHECK(c.origin == Vec3d{1, 2, 10});
    CHECK_FALSE(c.camera->usesLens());
    for (const Vec2 film : {Vec2{0, 0}, {600, 400}, {123, 45}}) {
        const Ray r = projectionRay(c, film);
        CHECK(r.direction == Vec3{0, 0, -1});
        CHECK(r.origin.x == doctest::Approx((static_cast<double>(film.x) - 300) * 0.01).epsilon(1e-6).scale(0));
        CHECK(r.origin.y == doctest::Approx((200 - static_cast<double>(film.y)) * 0.01).epsilon(1e-6).scale(0));
        CHECK(std::abs(r.origin.z) < 1e-6f);
        CHECK(r.time == 0.5f);
    }
    p.height.reset();
    p.width = 6;
    CHECK(length(projectionRay(test::made(makeOrthographic, p, {600, 400}), {600, 0}).origin -
                 projectionRay(c, {600, 0}).origin) < 1e-6f);
    p.exposure.value = 3;
    CHECK(test::made(makeOrthographic, p, {6, 4}).exposure.factor() == 8);
}

TEST_CASE("a panorama holds every direction once, linear in both angles") {
    const PlacedCamera c = test::made(makeSpherical, SphericalParams{}, {360, 180});
    const auto towards = [&](Vec2 film, Vec3 direction) {
        return length(projectionRay(c, film).direction - direction) < 1e-6f;
    };
    CHECK(towards({180, 90}, {0, 0, -1}));
    CHECK(towards({270, 90}, {1, 0, 0}));
    CHECK(towards({90, 90}, {-1, 0, 0}));
    CHECK(towards({0, 90}, {0, 0, 1}));
    CHECK(towards({360, 90}, {0, 0, 1}));
    CHECK(towards({77, 0}, {0, 1, 0}));
    CHECK(towards({77, 180}, {0, -1, 0}));
    CHECK(projectionRay(c, {10, 45}).direction.y == doctest::Approx(std::sin(45 * kProjectionDegree)));
    // The mean of the direction over all pixels, weighed by solid angle, is that of the sphere: nothing.
    Vec3d sum{};
    double solid = 0;
    for (int y = 0; y < 180; ++y)
        for (int x = 0; x < 360; ++x) {
            const Vec3d d(projectionRay(c, {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}).direction);
            const double weight = std::cos((89.5 - y) * kProjectionDegree) * kProjectionDegree * kProjectionDegree;
            sum += d * weight;
            solid += weight;
        }
    CHECK(solid == doctest::Approx(4 * kPiD).epsilon(1e-4).scale(0));
    CHECK(length(sum) < 1e-4);
}

TEST_CASE("part of a panorama") {
    SphericalParams p;
    p.width = 180 * kProjectionDegree;
    p.height = 60 * kProjectionDegree;
    p.lookAt = Vec3d{1, 0, 0};
    const PlacedCamera c = test::made(makeSpherical, p, {300, 100});
    CHECK(length(projectionRay(c, {150, 50}).direction - Vec3{1, 0, 0}) < 1e-6f);
    CHECK(length(projectionRay(c, {300, 50}).direction - Vec3{0, 0, 1}) < 1e-6f);
    CHECK(projectionRay(c, {150, 0}).direction.y == doctest::Approx(0.5).epsilon(1e-6).scale(0));
}

} // namespace
} // namespace abbe
