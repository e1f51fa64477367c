// Cameras from the text of a scene to pixels.
#include "scene_test_fixture.h"

#include <doctest/doctest.h>

namespace abbe::test {

namespace {

TestScene seenBy(const std::string& camera, const std::string& rest = "light sky { radiance 1 }\n") {
    return TestScene::parse("scene 1\n" + camera + "\nfilm { size 8 8 }\n" + rest);
}

// Y over the whole picture.
double brightness(const TestScene& scene, std::uint32_t samples) {
    const TestImage image = render(scene, samples);
    double sum = 0;
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) sum += image.film.mean(x, y).y / 64;
    return sum;
}

} // namespace

TEST_CASE("cameras: every type sees a uniform sky as it is") {
    for (const char* camera : {"camera { f-stop 2 { blades 5 }; tilt 5 0 deg }", "camera orthographic { width 3 }",
                               "camera spherical { }"}) {
        const auto scene = seenBy(camera);
        REQUIRE(scene.report() == "");
        CHECK(brightness(scene, 256) == doctest::Approx(1).epsilon(0.02));
    }
}

// Each path begins with the hero alone: the sum over wavelengths must still be that of all eight.
TEST_CASE("cameras: a lens of dispersing glass keeps the light of a thin lens") {
    const auto scene = seenBy("camera lens-system { prescription double-gauss; f-stop 8; sensor 2 2 mm }");
    REQUIRE(scene.report() == "");
    CHECK(scene.scene().effects.has(Effect::dispersion));
    CHECK(brightness(scene, 8192) == doctest::Approx(1).epsilon(0.015));
    const auto plain = seenBy("camera lens-system { surfaces mm { - stop 1 air 5; - 50 4 1.5 10; - flat 0 air 10 } }");
    REQUIRE(plain.report() == "");
    CHECK_FALSE(plain.scene().effects.has(Effect::dispersion));
}

TEST_CASE("cameras: the focus is measured to a shape, through groups") {
    const std::string ball = "light sky { radiance 1 }\ngroup g { transform { translate 0 0 -3 }; shape ball sphere { "
                             "center 0 0 -2; radius 0.5 } }\n";
    // A box and a mesh far from the origin keep their middle apart from their corners.
    const std::string box = "light sky { radiance 1 }\nshape ball box { center 0 0 -5 }\n";
    const std::string mesh =
        "light sky { radiance 1 }\ngroup { transform { translate 0 0 -1000 }\nshape ball mesh { points { "
        "- -0.1 0 995; - 0.1 0 995; - 0 0.1 995 }; faces { - 0 1 2 } } }\n";
    for (const std::string& shape : {ball, box, mesh}) {
        const auto scene = seenBy("camera { from 0 0 5; look-at 0 0 0; f-stop 1; focus on=ball }", shape);
        REQUIRE(scene.report() == "");
        const Ray a = scene.scene().camera->ray({{3, 3}, {0.1f, 0.2f}, 0, 550}).ray;
        const Ray b = scene.scene().camera->ray({{3, 3}, {0.8f, 0.9f}, 0, 550}).ray;
        const auto at = [](const Ray& r) { return r.origin + r.direction * ((-10 - r.origin.z) / r.direction.z); };
        CHECK(length(at(a) - at(b)) < 1e-4f);
    }
    CHECK(codes(seenBy("camera { focus on=balls }", ball)) == "E0202");
    CHECK(codes(seenBy("camera { f-stop 1; focus 2 on=ball }", ball)) == "E0306");
    CHECK(codes(seenBy("camera { f-stop 1; focus at=ball }", ball)) == "E0210");
    CHECK(codes(seenBy("camera { f-stop 1; focus on=floor }", ball + "shape floor plane { }\n")) == "E0354");
}

TEST_CASE("cameras: an exposure in stops, or automatic") {
    const Exposure fixed = seenBy("camera { exposure -2.5 stops }").built().cameraExposure;
    CHECK(fixed.stops == -2.5);
    CHECK_FALSE(fixed.automatic);
    for (const char* camera : {"{ exposure auto }", "orthographic { width 2; exposure auto }",
                               "spherical { exposure auto }", "lens-system { prescription singlet; exposure auto }"}) {
        const auto scene = seenBy(std::string("camera ") + camera);
        REQUIRE(scene.report() == "");
        CHECK(scene.built().cameraExposure.automatic);
        CHECK(scene.built().exposure == 1);
    }
    const auto photograph = seenBy("camera { f-stop 16; shutter \"1/100\" s; iso 100; exposure auto }");
    CHECK(photograph.built().cameraExposure.sensitivity ==
          doctest::Approx(72983.27 * kPiD / 1024 * 0.01 * 100 / 78).epsilon(1e-4));
    CHECK(codes(seenBy("camera { exposure auot }")) == "E0307");
    CHECK(codes(seenBy("camera { exposure auto 2 }")) == "E0306");
    CHECK(codes(seenBy("camera { exposure bright }")) == "E0307");
}

TEST_CASE("cameras: ISO, shutter and f-stop arrive; mistakes are located") {
    CHECK(seenBy("camera { f-stop 16; shutter \"1/100\" s; iso 100 }").built().exposure ==
          doctest::Approx(72983.27 * kPiD / 1024 * 0.01 * 100 / 78).epsilon(1e-4));
    CHECK(codes(seenBy("camera { iso 100 }")) == "E0353");
    CHECK(codes(seenBy("camera { iso 0; shutter 1 s; f-stop 2 }")) == "E0303");
    CHECK(codes(seenBy("camera { shutter 0 s }")) == "E0303");
    CHECK(codes(seenBy("camera { f-stop 2 { blade 9 } }")) == "E0201");
    CHECK(codes(seenBy("camera { f-stop 2 { blades 2 } }")) == "E0303");
    CHECK(codes(seenBy("camera { f-stop 2 { blades 5; blades 6 } }")) == "E0208");
    CHECK(codes(seenBy("camera { f-stop 2; aperture 3 mm }")) == "E0310");
    CHECK(codes(seenBy("camera orthographic { }")) == "E0207");
    CHECK(codes(seenBy("camera spherical { height 200 deg }")) == "E0303");
    CHECK(codes(seenBy("camera lens-system { }")) == "E0207");
    CHECK(codes(seenBy("camera lens-system { surfaces mm { } }")) == "E0306");
    CHECK(codes(seenBy("camera lens-system { surfaces kg { - stop 1 air 5 } }")) == "E0301");
    CHECK(codes(seenBy("camera lens-system { prescription double-gaus }")) == "E0307");
}

} // namespace abbe::test
