// How far the first surface moves on the film while the shutter is open, against closed forms.
#include "cameras/lens_system.h"
#include "support/layered_film.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

constexpr int kMotionWidth = 64, kMotionHeight = 48;

std::string motionLayerScene(const std::string& camera, const std::string& body) {
    return fmt::format("scene 1\nfilm {{ size {} {}; filter box 0.5; layers {{ motion; position }} }}\n{}\n"
                       "light sky {{ luminance 100 nits }}\n{}\n",
                       kMotionWidth, kMotionHeight, camera, body);
}

// Right and up, in pixels.
struct Motion2 {
    double u, v;
};
Motion2 motionAt(const LayeredFilm& image, int x, int y) {
    const auto i = image.at(x, y);
    return {image.plane("forward.u")[i], image.plane("forward.v")[i]};
}

// Of a camera at the origin that looks along -z, 40° wide.
Motion2 projected(Vec3d p) {
    const double scale = kMotionWidth / (2 * std::tan(20 * kPiD / 180));
    return {p.x / -p.z * scale, p.y / -p.z * scale};
}

constexpr const char* kMotionCamera = "camera { from 0 0 0; look-at 0 0 -1; fov 40 deg; shutter 1 s }";
constexpr const char* kWall = "shape wall quad { points { - -50 -50 -5; - 50 -50 -5; - 50 50 -5; - -50 50 -5 }; "
                              "material diffuse; ";

void checkAll(const LayeredFilm& image, Motion2 wanted, double tolerance = 1e-3) {
    for (int y = 0; y < kMotionHeight; ++y)
        for (int x = 0; x < kMotionWidth; ++x) {
            const Motion2 got = motionAt(image, x, y);
            REQUIRE(std::abs(got.u - wanted.u) < tolerance);
            REQUIRE(std::abs(got.v - wanted.v) < tolerance);
        }
}

} // namespace

TEST_CASE("what stands still has a motion of exactly 0") {
    for (const char* camera : {"camera { from 0.3 0.2 1; look-at 0 0 -1; fov 40 deg; shutter 1 s; f-stop 2 }",
                               "camera spherical { from 0 0 0; look-at 0 0 -1; shutter 1 s }",
                               "camera orthographic { from 0 0 0; look-at 0 0 -1; width 4 m; shutter 1 s }",
                               "camera lens-system { prescription double-gauss; lens 50 mm; f-stop 2.8; from 0 0 0; "
                               "look-at 0 0 -1; shutter 1 s }"}) {
        INFO(camera);
        const LayeredFilm image(motionLayerScene(camera, std::string(kWall) +
                                                             "}\nobject o { shape sphere { radius 0.5; "
                                                             "material diffuse } }\ninstance o { transform "
                                                             "{ rotate y 20 deg; translate 0.4 0 -3 } }"),
                                4);
        for (const char* plane : {"forward.u", "forward.v"})
            for (const float v : image.plane(plane)) REQUIRE(v == 0);
        REQUIRE(image.plane("position.Z")[image.at(32, 24)] != 0);
    }
}

TEST_CASE("a wall that moves sideways moves by its way over its distance, whenever it is seen") {
    const LayeredFilm image(motionLayerScene(kMotionCamera, std::string(kWall) +
                                                                "transform { at 0 s { translate 0 0 0 }; at 1 s { "
                                                                "translate 0.3 -0.2 0 } } }"),
                            8);
    const double scale = kMotionWidth / (2 * std::tan(20 * kPiD / 180)) / 5;
    checkAll(image, {0.3 * scale, -0.2 * scale});
}

TEST_CASE("a camera that moves moves everything the other way") {
    const LayeredFilm image(
        motionLayerScene("camera { fov 40 deg; shutter 1 s; at 0 s { from 0 0 0; look-at 0 0 -1 }; at 1 s "
                         "{ from 0.3 -0.2 0; look-at 0.3 -0.2 -1 } }",
                         std::string(kWall) + "}"),
        8);
    const double scale = kMotionWidth / (2 * std::tan(20 * kPiD / 180)) / 5;
    checkAll(image, {-0.3 * scale, 0.2 * scale});
}

TEST_CASE("a sphere that goes by shows the ways of its points") {
    // Towards the camera and to the side: points move by what each is away.
    const LayeredFilm image(motionLayerScene(kMotionCamera,
                                             "shape ball sphere { radius 0.8; material diffuse; transform { at 0 s { "
                                             "translate -0.1 0.1 -4 }; at 1 s { translate 0.1 0 -3.6 } } }"),
                            64);
    int seen = 0;
    for (int y = 20; y < 28; ++y)
        for (int x = 28; x < 36; ++x, ++seen) {
            // The middle of the pixel, at each moment another point of the ball: the mean of their ways.
            const double scale = kMotionWidth / (2 * std::tan(20 * kPiD / 180));
            const auto way = [&](double px, double py, double t) {
                const Vec3d d = normalize(Vec3d{(px - kMotionWidth / 2) / scale, (kMotionHeight / 2 - py) / scale, -1});
                const Vec3d from{-0.1, 0.1, -4}, to{0.1, 0, -3.6}, c = from + (to - from) * t;
                const double b = dot(c, d), h = b * b - lengthSquared(c) + 0.64;
                const Vec3d p = d * (b - std::sqrt(h));
                const Motion2 a = projected(p - c + from), e = projected(p - c + to);
                return Motion2{e.u - a.u, e.v - a.v};
            };
            Motion2 wanted{0, 0};
            constexpr int n = 12;
            for (int i = 0; i < n * n * n; ++i) {
                const Motion2 m = way(x + (i % n + 0.5) / n, y + (i / n % n + 0.5) / n, (i / n / n + 0.5) / n);
                wanted = {wanted.u + m.u / (n * n * n), wanted.v + m.v / (n * n * n)};
            }
            const Motion2 got = motionAt(image, x, y);
            // 64 samples of ways that differ by a fifth over the shutter.
            REQUIRE(std::abs(got.u - wanted.u) < 0.02);
            REQUIRE(std::abs(got.v - wanted.v) < 0.02);
        }
    CHECK(seen == 64);
    // In front of the sky nothing moves.
    CHECK(motionAt(image, 1, 1).u == 0);
}

TEST_CASE("an object that turns in one that moves, whose points are found again") {
    // A plate through the axis of view turns about it by 30°, inside a group that moves by 0.2: seen at one moment,
    // since the shutter opens for both ends alone.
    const std::string body = "object plate { shape quad { points { - -9 -9 0; - 9 -9 0; - 9 9 0; - -9 9 0 }; material "
                             "diffuse } }\ngroup carried { transform { at 0 s { translate 0 0 -5 }; at 1 s { translate "
                             "0.2 0 -5 } }\n instance plate { transform { at 0 s { rotate z 0 deg }; at 1 s { rotate z "
                             "30 deg } } } }";
    const LayeredFilm image(motionLayerScene(kMotionCamera, body), 64);
    const double scale = kMotionWidth / (2 * std::tan(20 * kPiD / 180)) / 5;
    // A point seen at q at the time t was at R(-30° t)(q - 0.2 t) at first: means over t by quadrature, q being even in
    // the pixel.
    Motion2 sum{0, 0};
    for (int py = 0; py < kMotionHeight; ++py)
        for (int px = 0; px < kMotionWidth; ++px) {
            const double x = (px + 0.5 - kMotionWidth / 2) / scale, y = (kMotionHeight / 2 - py - 0.5) / scale;
            double u = 0, v = 0;
            constexpr int n = 100;
            for (int i = 0; i < n; ++i) {
                const double t = (i + 0.5) / n, back = -t * kPiD / 6, on = (1 - t) * kPiD / 6;
                const double qx = x - 0.2 * t, qy = y;
                const double x0 = std::cos(back) * qx - std::sin(back) * qy;
                const double y0 = std::sin(back) * qx + std::cos(back) * qy;
                const double x1 = std::cos(on) * qx - std::sin(on) * qy + 0.2;
                const double y1 = std::sin(on) * qx + std::cos(on) * qy;
                u += (x1 - x0) * scale / n;
                v += (y1 - y0) * scale / n;
            }
            const Motion2 got = motionAt(image, px, py);
            REQUIRE(std::abs(got.u - u) < 0.1); // of some 10 pixels: noise of 64 moments
            REQUIRE(std::abs(got.v - v) < 0.1);
            sum = {sum.u + got.u - u, sum.v + got.v - v};
        }
    CHECK(std::abs(sum.u) / (kMotionWidth * kMotionHeight) < 0.001);
    CHECK(std::abs(sum.v) / (kMotionWidth * kMotionHeight) < 0.001);
}

TEST_CASE("a mesh that deforms: its corners move, and what lies between goes along") {
    // A sheet whose points move by a linear map: x grows by a tenth of y. Then any point's way is known from where it
    // is.
    const auto points = [](double shear) {
        std::string text = "points {";
        for (const auto& [x, y] : {std::pair{-9.0, -9.0}, {9.0, -9.0}, {9.0, 9.0}, {-9.0, 9.0}})
            text += fmt::format(" - {} {} -5;", x + shear * y, y);
        return text + " }";
    };
    const std::string body = "shape mesh { faces { - 0 1 2; - 0 2 3 }; material diffuse\n at 0 s { " + points(0) +
                             " }\n at 1 s { " + points(0.1) + " } }";
    const LayeredFilm image(motionLayerScene(kMotionCamera, body), 16);
    for (const int y : {2, 24, 45})
        for (const int x : {3, 30, 60}) {
            const Motion2 got = motionAt(image, x, y);
            // y stays, so the way is 0.1 y at all times: the mean over the pixel is that of its samples.
            const double py = kMotionHeight / 2 - y - 0.5;
            CHECK(std::abs(got.u - 0.1 * py) < 0.003); // 16 samples in a pixel of height 1
            CHECK(std::abs(got.v) < 1e-3);
        }
}

TEST_CASE("hairs and points go along with their axes and middles") {
    const std::string hair =
        "shape curves { basis linear; counts 2; radius 0.8; material diffuse\n at 0 s { points { - "
        "-3 0 -4; - 3 0 -4 } }\n at 1 s { points { - -2.8 0.1 -4; - 3.2 0.1 -4 } } }";
    const std::string dots = "shape points { radius 0.8; material diffuse\n at 0 s { points { - 0 0 -4 } }\n at 1 s { "
                             "points { - 0.2 0.1 -4 } } }";
    const double scale = kMotionWidth / (2 * std::tan(20 * kPiD / 180));
    for (const std::string& body : {dots, hair}) {
        INFO(body);
        const LayeredFilm image(motionLayerScene(kMotionCamera, body), 64);
        // The front of both is 3.2 away.
        CHECK(motionAt(image, 33, 23).u == doctest::Approx(0.2 * scale / 3.2).epsilon(0.01));
        CHECK(motionAt(image, 33, 23).v == doctest::Approx(0.1 * scale / 3.2).epsilon(0.02));
    }
}

TEST_CASE("panoramas: a way over the back edge is the short one") {
    const std::string camera = "camera spherical { from 0 0 0; look-at 0 0 -1; shutter 1 s }";
    // A ball behind the camera that goes round it by 4°.
    const LayeredFilm image(motionLayerScene(camera,
                                             "shape sphere { center 0 0 5; radius 1; material diffuse; transform { at "
                                             "0 s { rotate y 2 deg }; at 1 s { rotate y -2 deg } } }"),
                            32);
    for (const int x : {0, kMotionWidth - 1}) {
        const Motion2 got = motionAt(image, x, kMotionHeight / 2);
        CHECK(got.u == doctest::Approx(4.0 / 360 * kMotionWidth).epsilon(0.01));
        CHECK(std::abs(got.v) < 1e-2);
    }
}

TEST_CASE("cameras see points where their rays through the middle of the lens come from") {
    for (const char* camera :
         {"camera { from 0.3 0.2 1; look-at 0 0.4 -1; fov 50 deg; f-stop 2; shift 2 3 mm }",
          "camera { from 0.3 0.2 1; look-at 0 0.4 -1; lens 40 mm; squeeze 1.5; f-stop 4; tilt 5 3 deg }",
          "camera spherical { from 0 1 0; look-at 0.4 0.3 -1; width 200 deg; height 120 deg }",
          "camera orthographic { from 0 1 0; look-at 0.4 0.3 -1; width 4 m }",
          "camera lens-system { prescription double-gauss; lens 50 mm; f-stop 16; from 0 1 0; look-at 0.4 0.3 -1 }"}) {
        INFO(camera);
        const auto scene = TestScene::parse(motionLayerScene(camera, ""));
        const Camera& c = *scene.scene().camera;
        const bool real = dynamic_cast<const LensSystemCamera*>(&c) != nullptr;
        for (const Vec2 film : {Vec2{3, 5}, Vec2{32, 24}, Vec2{50, 40}, Vec2{63.5f, 10}}) {
            CameraSample at{film, {0.5f, 0.5f}, 0, 587.56f};
            const CameraRay ray = c.ray(at);
            const Vec3d p = Vec3d(ray.ray.origin) + Vec3d(ray.ray.direction) * 7.0;
            const auto seen = c.project(p, 0, Vec2d{static_cast<double>(film.x), static_cast<double>(film.y)});
            REQUIRE(seen);
            // Of real lenses the middle of the exit pupil is not exactly where that of the entrance pupil is seen.
            CHECK(std::abs(seen->x - static_cast<double>(film.x)) < (real ? 0.05 : 1e-3));
            CHECK(std::abs(seen->y - static_cast<double>(film.y)) < (real ? 0.05 : 1e-3));
        }
    }
}

} // namespace abbe::test
