// Cameras of glTF files in the language: where they stand, what they see, and what is said about wrong names.
#include "../io/gltf_support.h"
#include "scene_test_fixture.h"

#include <cmath>
#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>

namespace abbe::test {
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

} // namespace abbe::test
