// `visible-to` of shapes, groups, objects and instances: which rays meet what, and what cannot be hidden.
#include "scene_test_fixture.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

// The letters of the kinds of rays that meet anything along -z at x: camera, shadow, scattered.
std::string seenAt(const TestScene& scene, double x) {
    std::string seen;
    for (const auto& [kind, letter] :
         {std::pair{RayKind::camera, 'c'}, {RayKind::shadow, 's'}, {RayKind::scattered, 'r'}}) {
        const Ray ray{Vec3(Vec3d{x, 0, 4} - scene.scene().origin), {0, 0, -1}, kInfinity, 0, kind};
        SurfaceHit hit;
        const bool met = scene.scene().intersector->intersect(ray, hit);
        CHECK(met == scene.scene().intersector->occluded(ray));
        if (met) seen += letter;
    }
    return seen;
}

std::string shiftedBy(double x) { return fmt::format("transform {{ translate {} 0 0 }}", x); }

} // namespace

TEST_CASE("rays meet what is visible to them: shapes of all kinds, groups, objects, instances") {
    const TestScene scene = build("shape sphere { radius 0.4 }\n"
                                  "shape sphere { radius 0.4; visible-to camera; " +
                                  shiftedBy(1) +
                                  " }\n"
                                  "shape quad { visible-to shadows reflections; size 0.8 0.8; " +
                                  shiftedBy(2) +
                                  " }\n"
                                  "shape box { visible-to none; size 0.8 0.8 0.8; " +
                                  shiftedBy(3) +
                                  " }\n"
                                  "group { visible-to camera shadows; " +
                                  shiftedBy(4) +
                                  "\n shape sphere { radius 0.4; visible-to shadows reflections } }\n"
                                  "object pebble { visible-to camera reflections\n shape sphere { radius 0.4 }\n"
                                  "    shape sphere { radius 0.4; visible-to camera; " +
                                  shiftedBy(1) +
                                  " } }\n"
                                  "instance pebble { " +
                                  shiftedBy(5) +
                                  " }\n"
                                  "instance pebble { visible-to shadows reflections; " +
                                  shiftedBy(7) +
                                  " }\n"
                                  "object heap { instance pebble { visible-to reflections } }\n"
                                  "instance heap { " +
                                  shiftedBy(9) +
                                  " }\n"
                                  "instances pebble { grid 1 1 1; visible-to camera shadows; " +
                                  shiftedBy(11) + " }\n");
    const char* const expected[] = {"csr", "c", "sr", "", "s", "cr", "c", "r", "", "r", "", "c", "c"};
    for (int x = 0; x < 13; ++x) {
        CAPTURE(x);
        CHECK(seenAt(scene, x) == expected[x]);
    }
    CHECK(scene.scene().hidden.fromCamera);
    CHECK(scene.scene().hidden.splits);
}

TEST_CASE("lights in objects are hidden with their instances, and tell the scene") {
    const TestScene scene = build("object lantern { light quad { size 0.8 0.8; luminance 10 nits } }\n"
                                  "instance lantern { " +
                                  shiftedBy(1) +
                                  " }\n"
                                  "instance lantern { visible-to shadows reflections; " +
                                  shiftedBy(2) + " }\n");
    CHECK(seenAt(scene, 1) == "csr");
    CHECK(seenAt(scene, 2) == "sr");
    REQUIRE(scene.scene().lights.size() == 3);
    CHECK(scene.scene().lights[1]->visible() == kVisibleToAll);
    CHECK_FALSE(scene.scene().lights[2]->visible().has(RayKind::camera));
    CHECK(scene.scene().hidden.fromCamera);
    CHECK_FALSE(scene.scene().hidden.splits);
}

TEST_CASE("what light goes through is seen by all rays") {
    const auto report = [](const std::string& body) { return codes(build(body)); };
    CHECK(report("shape sphere { visible-to camera reflections; material dielectric { ior 1.5 } }") == "E0635");
    CHECK(report("shape sphere { visible-to reflections shadows; interior homogeneous { extinction 1 per-m } }") ==
          "E0635");
    CHECK(
        report(
            "object ball { shape sphere { material dielectric { ior 1.5 } } }\ninstance ball { visible-to camera }") ==
        "E0635");
    CHECK(report("shape sphere { visible-to camera reflections; material diffuse { opacity 0.5 } }") == "E0635");
    CHECK(report("shape sphere { visible-to shadows reflections; material diffuse { opacity 0.5 } }") == "");
    CHECK(report("shape quad { visible-to camera; material thin-dielectric }") == "");
    CHECK(report("shape sphere { visible-to camera shadows reflections; material dielectric { ior 1.5 } }") == "");
    CHECK(report("render { light-paths always }\nshape sphere { visible-to shadows }") == "E0636");
    CHECK(report("render { light-paths always }\nshape sphere { visible-to shadows reflections }") == "");
}

TEST_CASE("words of `visible-to`") {
    const auto report = [](const std::string& words) {
        return codes(build("shape sphere { visible-to " + words + " }"));
    };
    CHECK(report("camera") == "");
    CHECK(report("none") == "");
    CHECK(report("") == "E0306");
    CHECK(report("eye") == "E0307");
    CHECK(report("camera camera") == "E0306");
    CHECK(report("none camera") == "E0306");
    CHECK(report("3") == "E0314");
    CHECK(codes(build("group { visible-to eye\n shape sphere }")) == "E0307");
    CHECK(codes(build("light sky { visible-to shadows }")) == "E0307");
}

} // namespace abbe::test
