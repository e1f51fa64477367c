// What a lens may do besides being round and upright: blades, squeeze, shift, tilt, exposure.
#include "camera_fixture.h"
#include "cameras/perspective.h"

namespace abbe {
namespace {

using test::at;
using test::meets;

constexpr double kThinLensDegree = kPiD / 180;

PlacedCamera makeLens(const PerspectiveParams& p, Vec2i size = {360, 240}) {
    return test::made(makePerspective, p, size);
}
Ray lensRay(const PlacedCamera& c, Vec2 film, Vec2 lens = {0.5f, 0.5f}) {
    return c.camera->ray({film, lens, 0, 550}).ray;
}

TEST_CASE("the circle of confusion has the diameter of the textbook") {
    // A point at distance s before a lens of focal length f, focused at z: its image is c = f² |s - z| / (N s (z - f))
    // wide on the sensor [Ray2002]; a camera that keeps its field of view, f / (z - f) being f / z, has f² |s - z| / (N
    // s z).
    PerspectiveParams p;
    p.lens = 0.05;
    p.fStop = 2.8;
    p.focus = at(2);
    const PlacedCamera c = makeLens(p);
    test::Random random(3);
    for (const double s : {0.7, 1.5, 3.0, 10.0, 1000.0}) {
        // Of all rays through the edge of the lens, the film point that sees (0, 0, -s) is where the ray from there
        // through that edge crosses the sharp plane: its distance from the middle, scaled to the sensor by f / z.
        double widest = 0;
        for (int i = 0; i < 4000; ++i) {
            const Ray r = lensRay(c, {180, 120}, {random.uniform(), random.uniform()});
            const Vec2d miss = meets(r, s); // of the ray that belongs to the middle of the film
            widest = std::max(widest, std::hypot(miss.x, miss.y) * 0.05 / s);
        }
        const double textbook = 0.05 * 0.05 * std::abs(s - 2) / (2.8 * s * 2);
        CHECK(2 * widest == doctest::Approx(textbook).epsilon(2e-3).scale(0));
        CHECK(2 * widest <= textbook * (1 + 1e-4));
    }
}

TEST_CASE("blades shape the blur and keep its area") {
    PerspectiveParams p;
    p.fStop = 2;
    p.focus = at(1);
    p.blades = 5;
    const PlacedCamera c = makeLens(p);
    test::Random random(4);
    double highest = 0, widest = 0, square = 0;
    constexpr int kRays = 100'000;
    for (int i = 0; i < kRays; ++i) {
        const Vec3 o = lensRay(c, {10, 20}, {random.uniform(), random.uniform()}).origin;
        highest = std::max(highest, static_cast<double>(o.y));
        widest = std::max(widest, static_cast<double>(o.x));
        square += test::exact(o).y * test::exact(o).y / kRays;
    }
    const double corner = 0.0125 * std::sqrt(2 * kPiD / (5 * std::sin(72 * kThinLensDegree)));
    CHECK(highest == doctest::Approx(corner).epsilon(5e-3).scale(0));
    CHECK(widest == doctest::Approx(corner * std::cos(18 * kThinLensDegree)).epsilon(5e-3).scale(0));
    // Second moment of a regular polygon about any axis: A R² (2 + cos(2π/n)) / 12.
    CHECK(square ==
          doctest::Approx(corner * corner * (2 + std::cos(72 * kThinLensDegree)) / 12).epsilon(0.01).scale(0));
}

TEST_CASE("an anamorphic lens doubles the width and makes the blur oval") {
    PerspectiveParams p;
    p.lens = 0.05;
    p.fStop = 2;
    p.squeeze = 2;
    p.sensor = {0.024, 0.018};
    p.focus = at(3);
    const PlacedCamera c = makeLens(p, {480, 180});
    CHECK(meets(lensRay(c, {480, 90}), 1).x == doctest::Approx(0.024 / 0.05).epsilon(1e-5).scale(0));
    CHECK(meets(lensRay(c, {240, 0}), 1).y == doctest::Approx(0.009 / 0.05).epsilon(1e-5).scale(0));
    test::Random random(5);
    double x = 0, y = 0;
    for (int i = 0; i < 20'000; ++i) {
        const Vec3 o = lensRay(c, {100, 20}, {random.uniform(), random.uniform()}).origin;
        x = std::max(x, static_cast<double>(o.x));
        y = std::max(y, static_cast<double>(o.y));
    }
    CHECK(y == doctest::Approx(0.0125).epsilon(5e-3).scale(0));
    CHECK(x == doctest::Approx(0.00625).epsilon(5e-3).scale(0));
}

TEST_CASE("a raised lens shows what is above, and keeps uprights upright") {
    PerspectiveParams p;
    p.lens = 0.024;
    p.shift = {0, 0.011};
    const PlacedCamera c = makeLens(p);
    CHECK(meets(lensRay(c, {180, 120}), 24).y == doctest::Approx(11).epsilon(1e-6).scale(0));
    CHECK(meets(lensRay(c, {180, 0}), 24).y == doctest::Approx(23).epsilon(1e-6).scale(0));
    CHECK(meets(lensRay(c, {0, 240}), 24).x == doctest::Approx(meets(lensRay(c, {0, 0}), 24).x).epsilon(1e-6).scale(0));
    p.shift = {0.005, 0};
    CHECK(meets(lensRay(makeLens(p), {180, 120}), 24).x == doctest::Approx(5).epsilon(1e-6).scale(0));
}

TEST_CASE("the plane of a tilted lens is sharp, and meets lens and sensor in one line") {
    PerspectiveParams p;
    p.lens = 0.09;
    p.fStop = 4;
    p.focus = at(2);
    for (const Vec2d tilt : {Vec2d{8, 0}, {0, -5}, {6, 11}}) {
        p.tilt = {tilt.x * kThinLensDegree, tilt.y * kThinLensDegree};
        const PlacedCamera c = makeLens(p);
        // Normal of the lens towards the sensor; the distance v of the sensor from f/v = mz - f/Z0.
        const Vec3d m = [&] {
            const Transform down = Transform::rotate({1, 0, 0}, -p.tilt.x),
                            right = Transform::rotate({0, 1, 0}, -p.tilt.y);
            return right.vector(down.vector({0, 0, 1}));
        }();
        const double f = 0.09, fOverV = m.z - f / 2;
        // Sharp: -P·m - Z f/v = f, where Z = -P.z.
        const auto off = [&](Vec3d q) { return -dot(q, m) + q.z * fOverV - f; };
        CHECK(std::abs(off({0, 0, -2})) < 1e-9);
        test::Random random(6);
        for (const Vec2 film : {Vec2{180, 120}, {90, 150}, {250, 100}, {180, 200}}) {
            const Vec3d d = test::exact(lensRay(c, film).direction); // through the middle of the lens
            const double t = f / (-dot(d, m) + d.z * fOverV);
            REQUIRE(t > 0);
            const Vec3d sharp = d * t;
            CHECK(std::abs(off(sharp)) < 1e-9);
            for (int i = 0; i < 200; ++i) {
                const Ray r = lensRay(c, film, {random.uniform(), random.uniform()});
                const Vec3d o = test::exact(r.origin), w = test::exact(r.direction);
                CHECK(std::abs(dot(o, m)) < 1e-8);
                const Vec3d miss = cross(sharp - o, w);
                CHECK(length(miss) < 1e-6 * length(sharp));
            }
        }
        // Scheimpflug: points of both the lens plane P·m = 0 and the sensor z = v satisfy the third plane's equation.
        const double v = f / fOverV;
        for (const double x : {-1.0, 2.0}) {
            const Vec3d q =
                std::abs(m.y) > 1e-6 ? Vec3d{x, (-x * m.x - v * m.z) / m.y, v} : Vec3d{-v * m.z / m.x, x, v};
            CHECK(std::abs(dot(q, m)) < 1e-9);
            CHECK(std::abs(off(q)) < 1e-9);
        }
    }
    // Turned down, the near ground is in focus with the far horizon.
    p.tilt = {8 * kThinLensDegree, 0};
    const Ray low = lensRay(makeLens(p), {180, 220}, {0.5f, 0.95f}), axis = lensRay(makeLens(p), {180, 220});
    const double near = -axis.direction.y > 0 ? 1.5 : 3;
    CHECK(std::hypot(meets(low, near).x - meets(axis, near).x, meets(low, near).y - meets(axis, near).y) <
          std::hypot(meets(low, 2).x - meets(axis, 2).x, meets(low, 2).y - meets(axis, 2).y));
}

TEST_CASE("a lens without movements has the rays of the plain formula") {
    PerspectiveParams p;
    p.fStop = 2;
    p.focus = at(3);
    const PlacedCamera plain = makeLens(p);
    p.tilt = {1e-9, 0};
    const PlacedCamera tilted = makeLens(p);
    for (const Vec2 lens : {Vec2{0.2f, 0.7f}, {0.9f, 0.1f}}) {
        CHECK(length(lensRay(plain, {20, 30}, lens).direction - lensRay(tilted, {20, 30}, lens).direction) < 1e-6f);
        CHECK(length(lensRay(plain, {20, 30}, lens).origin - lensRay(tilted, {20, 30}, lens).origin) < 1e-8f);
    }
}

TEST_CASE("the focus on a shape is the distance of its middle along the axis") {
    PerspectiveParams p;
    p.fStop = 2;
    p.from = Vec3d{1, 2, 10};
    p.lookAt = Vec3d{1, 2, 0};
    p.focus = schema::Location{std::nullopt, "ball", {}};
    CameraContext context = test::cameraContext({100, 100});
    context.middleOf = [](std::string_view name, double) {
        return name == "ball"     ? std::optional(Vec3d{3, 1, 4})
               : name == "behind" ? std::optional(Vec3d{0, 0, 12})
                                  : std::nullopt;
    };
    Diagnostics diagnostics;
    auto camera = makePerspective(p, context, diagnostics);
    REQUIRE(camera);
    const Vec2d a = meets(lensRay(*camera, {20, 30}), 6), b = meets(lensRay(*camera, {20, 30}, {0.1f, 0.2f}), 6);
    CHECK(std::hypot(a.x - b.x, a.y - b.y) < 1e-5);
    p.focus->shape = "behind";
    CHECK(test::codeOf(makePerspective, p, context) == "E0354");
    p.focus->shape = "plane";
    CHECK(test::codeOf(makePerspective, p, context) == "E0354");
}

TEST_CASE("exposure in the units of photography") {
    constexpr double kNits = 72983.27; // of Y = 1
    PerspectiveParams p;
    p.exposure.value = 1;
    CHECK(makeLens(p).exposure.factor() == 2);
    p.shutter = 0.01;
    CHECK(makeLens(p).exposure.factor() == 2); // the shutter alone moves, and does not expose
    CHECK(makeLens(p).shutter.exposure == 0.01);
    // Sunny 16: f/16 and a shutter of 1/ISO. A grey card of 18 % under 100 000 lx has 5730 nits; the sensor receives
    // 5730 π / (4·256) lx · 0.01 s = 0.1758 lx s of the 0.78 that saturate it: 22.5 %.
    p.exposure.value = 0;
    p.fStop = 16;
    p.iso = 100;
    CHECK(makeLens(p).exposure.factor() * (0.18 * 100'000 / kPiD) / kNits ==
          doctest::Approx(0.2254).epsilon(1e-3).scale(0));
    // A stop is a stop, wherever it is taken.
    const double base = makeLens(p).exposure.factor();
    p.iso = 200;
    CHECK(makeLens(p).exposure.factor() == doctest::Approx(2 * base));
    p.shutter = 0.005;
    CHECK(makeLens(p).exposure.factor() == doctest::Approx(base));
    p.fStop = 16 / std::sqrt(2.0);
    CHECK(makeLens(p).exposure.factor() == doctest::Approx(2 * base));
    p.exposure.value = -1;
    CHECK(makeLens(p).exposure.factor() == doctest::Approx(base));
    // The diameter says the same as the f-number.
    p.fStop.reset();
    p.aperture = 0.05 / 16 * std::sqrt(2.0);
    CHECK(makeLens(p).exposure.factor() == doctest::Approx(base));
}

TEST_CASE("half an exposure, and blades without a number, are reported") {
    const CameraContext context = test::cameraContext({4, 4});
    PerspectiveParams p;
    p.iso = 100;
    CHECK(test::codeOf(makePerspective, p, context) == "E0353");
    p.shutter = 0.01;
    CHECK(test::codeOf(makePerspective, p, context) == "E0353");
    p.shutter.reset();
    p.fStop = 4;
    CHECK(test::codeOf(makePerspective, p, context) == "E0353");
    p.iso.reset();
    p.bladeRotation = 0.1;
    CHECK(test::codeOf(makePerspective, p, context) == "E0353");
}

} // namespace
} // namespace abbe
