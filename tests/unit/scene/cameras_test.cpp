// Cameras from the text of a scene to pixels.
#include "../io/gltf_support.h"
#include "scene_test_fixture.h"

#include <cmath>
#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>

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

// Cameras of glTF files in the language: where they stand, what they see, and what is said about wrong names.
namespace {

// "Eye" looks along +x from (1, 2, 3) and its parent is ten times as large; "Plan" looks down from (0, 4, 0).
class ShotFile {
  public:
    explicit ShotFile(const std::string& cameras = "[0,1]", const std::string& eyeScale = "10,10,10")
        : path_(std::filesystem::temp_directory_path() / "abbe_camera_gltf_test.glb") {
        GltfText text;
        text.scene = R"("scene":0,"scenes":[{"nodes":)" + cameras + "}],";
        const std::string half = fmt::format("{:.9f}", std::sqrt(0.5));
        text.nodes = R"([{"scale":[)" + eyeScale +
                     R"(],"children":[2]},{"name":"Plan","camera":1,"translation":[0,4,0],)"
                     R"("rotation":[-)" +
                     half + ",0,0," + half +
                     R"(]},{"name":"Eye","camera":0,)"
                     R"("translation":[0.1,0.2,0.3],"rotation":[0,-)" +
                     half + ",0," + half + "]}]";
        text.more = R"(,"cameras":[{"type":"perspective","perspective":{"yfov":1.0,"aspectRatio":1.5,"znear":0.1}},)"
                    R"({"type":"orthographic","orthographic":{"xmag":2,"ymag":1,"znear":0,"zfar":9}}])";
        std::ofstream(path_, std::ios::binary) << text.binary();
    }
    ~ShotFile() { std::filesystem::remove(path_); }
    ShotFile(const ShotFile&) = delete;
    ShotFile& operator=(const ShotFile&) = delete;
    TestScene scene(const std::string& properties, const std::string& header = "scene 1") const {
        return TestScene::parse(header + "\ncamera main gltf \"" + path_.string() + "\" { " + properties +
                                " }\nfilm { size 30 20 }\n" + kSky);
    }

  private:
    std::filesystem::path path_;
};

// In world space.
Ray rayAt(const TestScene& scene, Vec2 film, Vec2 lens = {0.5f, 0.5f}) {
    return scene.scene().camera->ray({film, lens, 0, 550}).ray;
}
Vec3d originOf(const TestScene& scene, const Ray& ray) { return Vec3d(ray.origin) + scene.scene().origin; }

} // namespace

TEST_CASE("camera gltf: a perspective camera stands, looks and sees as its node says") {
    const auto scene = ShotFile().scene("name \"Eye\"");
    REQUIRE(scene.report() == "");
    const Ray middle = rayAt(scene, {15, 10}), top = rayAt(scene, {15, 0}), right = rayAt(scene, {30, 10});
    CHECK(near(originOf(scene, middle), {1, 2, 3}));
    CHECK(near(Vec3d(middle.direction), {1, 0, 0}));
    CHECK(std::acos(dot(top.direction, middle.direction)) == doctest::Approx(0.5).epsilon(1e-5));
    CHECK(top.direction.y > 0);
    CHECK(right.direction.z > 0);
    CHECK(right.direction.z / right.direction.x == doctest::Approx(1.5 * std::tan(0.5)).epsilon(1e-5));
}

TEST_CASE("camera gltf: scenes with z up and other lengths") {
    const auto zUp = ShotFile().scene("name \"Eye\"", "scene 1 up=z length=cm");
    REQUIRE(zUp.report() == "");
    CHECK(near(originOf(zUp, rayAt(zUp, {15, 10})), {1, -3, 2}));
    CHECK(near(Vec3d(rayAt(zUp, {15, 10}).direction), {1, 0, 0}));
    CHECK(rayAt(zUp, {15, 0}).direction.z > 0);
}

TEST_CASE("camera gltf: orthographic cameras keep their height") {
    const auto scene = ShotFile().scene("name \"Plan\"");
    REQUIRE(scene.report() == "");
    const Ray top = rayAt(scene, {15, 0}), left = rayAt(scene, {0, 10});
    CHECK(near(Vec3d(top.direction), {0, -1, 0}));
    CHECK(near(originOf(scene, top), {0, 4, -1}));
    CHECK(near(originOf(scene, left), {-1.5, 4, 0}));
    CHECK(codes(ShotFile().scene("name \"Plan\"; f-stop 2")) == "E0358");
    CHECK(codes(ShotFile().scene("name \"Plan\"; exposure 2 stops")) == "");
}

TEST_CASE("camera gltf: the scene's own focus, aperture and exposure") {
    const auto scene = ShotFile().scene("name \"Eye\"; f-stop 1; focus 5; exposure 1 stops");
    REQUIRE(scene.report() == "");
    CHECK(scene.built().exposure == doctest::Approx(2));
    const Ray a = rayAt(scene, {4, 7}, {0.1f, 0.2f}), b = rayAt(scene, {4, 7}, {0.9f, 0.7f});
    CHECK(length(a.origin - b.origin) > 0.01f); // 36 mm on 1.5 tan 0.5: 22 mm of focal length
    const auto at = [&](const Ray& r) { return r.origin + r.direction * ((5 - r.origin.x) / r.direction.x); };
    CHECK(length(at(a) - at(b)) < 1e-5f);
}

TEST_CASE("camera gltf: which camera") {
    CHECK(ShotFile("[1]").scene("").report() == "");
    CHECK(codes(ShotFile().scene("")) == "E0358");
    const auto wrong = ShotFile().scene("name \"Camera.001\"");
    CHECK(codes(wrong) == "E0358");
    const Diagnostic& d = wrong.diagnostics().all()[0];
    CHECK(d.message == "the file has no camera `Camera.001`");
    CHECK(d.help == "its cameras are `Eye` and `Plan`");
    CHECK(d.span.valid());
    CHECK(codes(ShotFile("[]").scene("")) == "E0358");
    CHECK(codes(ShotFile("[0,1]", "1,2,1").scene("name \"Eye\"")) == "E0351");
    CHECK(codes(ShotFile("[0,1]", "-1,1,1").scene("name \"Eye\"")) == "E0351");
    CHECK(codes(ShotFile("[0,1]", "1,\"x\",1").scene("name \"Eye\"")) == "E0402");
    for (const char* stated : {"fov 30 deg", "from 0 0 1", "transform { rotate y 3 deg }"})
        CHECK(codes(ShotFile().scene(std::string("name \"Eye\"; ") + stated)) == "E0201");
}

// A camera inside of an opaque body is found before anything is rendered.
namespace {

// With the camera at (0, 0, 5).
std::string found(const std::string& body) { return codes(build(body)); }

} // namespace

TEST_CASE("camera: inside of an opaque body it sees nothing") {
    const std::string ball = "shape ball sphere { center 0 0 5; radius 1; material diffuse }\n";
    const auto scene = build(ball);
    CHECK(codes(scene) == "W0696");
    CHECK(scene.diagnostics().all()[0].help == "move the camera out of `ball`: its picture would be black");
    CHECK(found("shape box { center 0 0 5; size 1 1 1; material conductor { index metal Au } }\n") == "W0696");
    CHECK(found(ball + "light point { position 0 9 5; intensity 5 cd }\n") == "W0696"); // outside
}

TEST_CASE("camera: in rooms, glass and open bodies it sees") {
    const std::string room = "shape box { center 0 0 5; size 4 4 4; material diffuse }\n";
    CHECK(found(room + "light point { position 1 1 5; intensity 5 cd }\n") == "");
    CHECK(found(room + "light quad { size 0.1 0.1; luminance 5 nits; transform { translate 0 1.9 5 } }\n") == "");
    // A light behind a column: what the camera sees is lit.
    CHECK(found(room + "shape cylinder { center 0.5 0 5; radius 0.2; height 1; material diffuse { reflectance 0.4 } }\n"
                       "light point { position 1.5 0 5; intensity 5 cd }\n") == "");
    CHECK(found("shape sphere { center 0 0 5; radius 1; material dielectric }\n") == "");
    CHECK(found("shape sphere { center 0 0 5; radius 1; material diffuse { opacity 0.5 } }\n") == "");
    CHECK(found("shape sphere { center 0 0 5; radius 1; emission 1 }\n") == "");
    CHECK(found("shape sphere { center 0 0 0; radius 1; material diffuse }\n") == "");
    CHECK(found("shape cylinder { center 0 0 5; radius 1; height 2; caps off; material diffuse }\n") == "");
}

} // namespace abbe::test
