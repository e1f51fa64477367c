// Projection of known points, the sharp plane of the lens, and the ends of every range.
#include "cameras/perspective.h"
#include "support/statistics.h"

#include <cmath>
#include <doctest/doctest.h>

namespace abbe {
namespace {

constexpr double kPerspectiveDegree = kPiD / 180;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

CameraContext context(Vec2i size) {
    return {.toWorld = {}, .zUp = false, .filmSize = size, .span = {}, .middleOf = {}};
}

schema::Location focusAt(double distance) { return {distance, {}, {}}; }

PlacedCamera makePerspectiveCamera(const PerspectiveParams& p, Vec2i size, bool zUp = false) {
    Diagnostics diagnostics;
    CameraContext c = context(size);
    c.zUp = zUp;
    auto camera = makePerspective(p, c, diagnostics);
    REQUIRE(camera);
    CHECK(diagnostics.all().empty());
    return std::move(*camera);
}

Ray perspectiveRay(const PlacedCamera& c, Vec2 film, Vec2 lens = {0.5f, 0.5f}) {
    return c.camera->ray({film, lens, 0.25f}).ray;
}

// Where a ray meets the plane at a distance along the axis, relative to the axis: x right and y up.
Vec2d meetsPlane(const Ray& r, double distance) {
    const double t = (-distance - r.origin.z) / r.direction.z;
    return {r.origin.x + t * r.direction.x, r.origin.y + t * r.direction.y};
}

TEST_CASE("without any parameter: 50 mm on 36 mm, from the origin along -z") {
    const PlacedCamera c = makePerspectiveCamera({}, {360, 240});
    CHECK(c.origin == Vec3d{});
    CHECK(length(perspectiveRay(c, {180, 120}).direction - Vec3{0, 0, -1}) < 1e-6f);
    CHECK(meetsPlane(perspectiveRay(c, {360, 120}), 50).x == doctest::Approx(18).epsilon(1e-6));
    CHECK(meetsPlane(perspectiveRay(c, {180, 0}), 50).y == doctest::Approx(12).epsilon(1e-6));
    CHECK(perspectiveRay(c, {10, 10}).time == 0.25f);
    CHECK(length(perspectiveRay(makePerspectiveCamera({}, {360, 240}, true), {180, 120}).direction - Vec3{0, 1, 0}) <
          1e-6f);
}

TEST_CASE("known points fall on known pixels") {
    PerspectiveParams p;
    p.from = Vec3d{278, 273, -800};
    p.lookAt = Vec3d{278, 273, 0};
    p.lens = 0.035;
    p.sensor = {0.025, 0.025};
    const PlacedCamera c = makePerspectiveCamera(p, {512, 512});
    CHECK(c.origin == Vec3d{278, 273, -800});
    // The camera looks along +z, so that +x is on the left.
    const double half = 800 * 12.5 / 35; // of what the picture spans at z = 0
    const auto seen = [&](Vec3d world) {
        const Vec3 toPoint = normalize(Vec3(world - c.origin));
        const Vec2 film{static_cast<float>(256 - (world.x - 278) / half * 256),
                        static_cast<float>(256 - (world.y - 273) / half * 256)};
        return length(perspectiveRay(c, film).direction - toPoint);
    };
    for (const Vec3d world : {Vec3d{278, 273, 0}, {0, 0, 0}, {556, 0, 0}, {100, 500, 0}}) CHECK(seen(world) < 1e-6f);
    const Vec3 left = perspectiveRay(c, {0, 256}).direction, right = perspectiveRay(c, {512, 256}).direction;
    CHECK(std::acos(dot(left, right)) / kPerspectiveDegree == doctest::Approx(39.31).epsilon(1e-4));
}

TEST_CASE("the width is kept where the shape of the film differs, and pixels are square") {
    PerspectiveParams p;
    p.fov = 60 * kPerspectiveDegree;
    for (const Vec2i size : {Vec2i{300, 100}, {100, 300}, {1, 1}, {32768, 1}}) {
        const PlacedCamera c = makePerspectiveCamera(p, size);
        const float w = static_cast<float>(size.x), h = static_cast<float>(size.y);
        const Vec2d corner = meetsPlane(perspectiveRay(c, {0, 0}), 1),
                    middle = meetsPlane(perspectiveRay(c, {w / 2, h / 2}), 1);
        CHECK(corner.x == doctest::Approx(-std::tan(30 * kPerspectiveDegree)).epsilon(1e-6));
        CHECK(corner.y == doctest::Approx(std::tan(30 * kPerspectiveDegree) * size.y / size.x).epsilon(1e-5));
        CHECK(std::abs(middle.x) + std::abs(middle.y) < 1e-6);
    }
}

TEST_CASE("up is up, and right is right") {
    PerspectiveParams p;
    p.from = Vec3d{0, 0, 5};
    p.lookAt = Vec3d{5, 0, 5}; // east
    p.up = Vec3d{0.3, 2, 0};
    const PlacedCamera c = makePerspectiveCamera(p, {100, 100});
    CHECK(perspectiveRay(c, {50, 0}).direction.y > 0);
    CHECK(perspectiveRay(c, {100, 50}).direction.z > 0); // south is right of east
    PerspectiveParams turned;
    turned.transform = Transform::rotate({0, 1, 0}, -kPiD / 2).then(Transform::translate({0, 0, 5}));
    const PlacedCamera same = makePerspectiveCamera(turned, {100, 100});
    CHECK(length(same.origin - c.origin) < 1e-12);
    CHECK(length(perspectiveRay(same, {13, 77}).direction - perspectiveRay(c, {13, 77}).direction) < 1e-6f);
}

TEST_CASE("all rays of a film point meet in the sharp plane, and only there") {
    PerspectiveParams p;
    p.lens = 0.05;
    p.fStop = 2;
    p.focus = focusAt(3);
    const PlacedCamera c = makePerspectiveCamera(p, {360, 240});
    test::Random random(1);
    const Vec2 film{70, 200};
    const Vec2d sharp = meetsPlane(perspectiveRay(c, film), 3);
    CHECK(sharp.x == doctest::Approx(3 / 0.05 * 0.036 * (70.0 / 360 - 0.5)).epsilon(1e-5));
    double widest = 0;
    for (int i = 0; i < 1000; ++i) {
        const Ray r = perspectiveRay(c, film, {random.uniform(), random.uniform()});
        const Vec2d focusAt = meetsPlane(r, 3);
        CHECK(std::hypot(focusAt.x - sharp.x, focusAt.y - sharp.y) < 2e-6);
        const double off = std::hypot(r.origin.x, r.origin.y);
        CHECK(off < 0.0125001); // 50 mm / 2 / 2
        widest = std::max(widest, off);
        // Twice as far the circle of confusion is as large as the lens.
        CHECK(std::hypot(meetsPlane(r, 6).x - 2 * sharp.x, meetsPlane(r, 6).y - 2 * sharp.y) ==
              doctest::Approx(off).epsilon(1e-3));
    }
    CHECK(widest > 0.0124);
}

TEST_CASE("the aperture by its diameter or by its f-number; the focus on the point looked at") {
    PerspectiveParams p;
    p.from = Vec3d{0, 0, 4};
    p.lookAt = Vec3d{0, 0, 0};
    p.aperture = 0.025;
    const PlacedCamera c = makePerspectiveCamera(p, {100, 100});
    CHECK(length(perspectiveRay(c, {50, 50}, {1, 0.5f}).origin) == doctest::Approx(0.0125).epsilon(1e-5));
    CHECK(std::abs(meetsPlane(perspectiveRay(c, {50, 50}, {1, 0.5f}), 4).x) < 1e-6);
    p.aperture.reset();
    p.fStop = 2;
    p.fov = 2 * std::atan(0.36);
    CHECK(length(perspectiveRay(makePerspectiveCamera(p, {100, 100}), {50, 50}, {1, 0.5f}).origin) ==
          doctest::Approx(0.0125).epsilon(1e-5));
}

// Hard case 79.
TEST_CASE("the ends of all ranges give finite unit directions") {
    const schema::TypeInfo type = perspectiveType();
    const auto ends = [&](std::string_view field) {
        return std::array{type.find(field)->lower, type.find(field)->upper};
    };
    for (const double fov : ends("fov"))
        for (const double focus : ends("focus"))
            for (const double aperture : ends("aperture")) {
                PerspectiveParams p;
                p.fov = fov;
                p.focus = focusAt(focus);
                p.aperture = aperture;
                const PlacedCamera c = makePerspectiveCamera(p, {64, 32});
                for (const Vec2 film : {Vec2{0, 0}, {64, 32}, {31.5f, 0.5f}})
                    for (const Vec2 lens : {Vec2{0, 0}, {0.5f, 0.5f}, {kOneMinusEpsilon, kOneMinusEpsilon}}) {
                        const Ray r = perspectiveRay(c, film, lens);
                        CHECK(isFinite(r.origin));
                        CHECK(length(r.direction) == doctest::Approx(1).epsilon(1e-5));
                    }
            }
    for (const double lens : ends("lens"))
        for (const double stop : {ends("f-stop")[0], 1e30, kInfinite})
            for (const double sensor : ends("sensor")) {
                PerspectiveParams p;
                p.lens = lens;
                p.fStop = stop;
                p.sensor = {sensor, sensor};
                CHECK(length(perspectiveRay(makePerspectiveCamera(p, {64, 32}), {0, 0}, {0, 0}).direction) ==
                      doctest::Approx(1).epsilon(1e-5));
            }
}

TEST_CASE("a focus at infinity gives parallel rays, an f-number of infinity a pinhole") {
    PerspectiveParams p;
    p.aperture = 0.1;
    p.focus = focusAt(kInfinite);
    const PlacedCamera c = makePerspectiveCamera(p, {100, 100});
    CHECK(length(perspectiveRay(c, {20, 30}, {0.1f, 0.9f}).direction - perspectiveRay(c, {20, 30}).direction) < 1e-7f);
    CHECK(length(perspectiveRay(c, {20, 30}, {0.1f, 0.9f}).origin) > 0.01f);
    PerspectiveParams pinhole;
    pinhole.fStop = kInfinite;
    CHECK(perspectiveRay(makePerspectiveCamera(pinhole, {100, 100}), {20, 30}, {0.1f, 0.9f}).origin == Vec3{});
}

TEST_CASE("impossible placements are reported") {
    const auto code = [](const PerspectiveParams& p) -> std::string {
        Diagnostics diagnostics;
        CHECK_FALSE(makePerspective(p, context({4, 4}), diagnostics).has_value());
        return diagnostics.all().size() == 1 ? diagnostics.all()[0].code : "";
    };
    PerspectiveParams p;
    p.lookAt = Vec3d{};
    CHECK(code(p) == "E0352");
    p.lookAt = Vec3d{0, 2, 0}; // along `up`
    CHECK(code(p) == "E0352");
    p.transform = Transform{};
    CHECK(code(p) == "E0350");
    PerspectiveParams mirrored;
    mirrored.transform = Transform::scale({-1, 1, 1});
    CHECK(code(mirrored) == "E0351");
    mirrored.transform = Transform::scale({1, 2, 1});
    CHECK(code(mirrored) == "E0351");
}

TEST_CASE("a camera far from the origin has the same rays") {
    PerspectiveParams p, q;
    p.lookAt = Vec3d{1, 2, -3};
    q.from = Vec3d{1e6, -2e6, 3e6};
    q.lookAt = *q.from + *p.lookAt;
    const PlacedCamera a = makePerspectiveCamera(p, {100, 100}), b = makePerspectiveCamera(q, {100, 100});
    CHECK(b.origin == *q.from);
    CHECK(length(perspectiveRay(a, {3, 4}).direction - perspectiveRay(b, {3, 4}).direction) < 1e-6f);
}

} // namespace
} // namespace abbe
