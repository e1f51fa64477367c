// glTF files as meshes of a scene: metres and y up whatever the scene's units are.
#include "../io/gltf_maker.h"
#include "scene_test_fixture.h"

#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>

namespace abbe::test {
namespace {

class TemporaryGlb {
  public:
    explicit TemporaryGlb(const std::string& bytes)
        : path_(std::filesystem::temp_directory_path() / "abbe_scene_test_square.glb") {
        std::ofstream(path_, std::ios::binary) << bytes;
    }
    ~TemporaryGlb() { std::filesystem::remove(path_); }
    std::string path() const { return path_.string(); }

  private:
    std::filesystem::path path_;
};

} // namespace

TEST_CASE("gltf: metres and y up in any scene, nodes by name") {
    GltfText text;
    text.nodes = R"([{"name":"A","mesh":0,"translation":[0,2,1]},{"name":"B","mesh":0,"translation":[5,0,0]}])";
    text.scene = R"("scene":0,"scenes":[{"nodes":[0,1]}],)";
    const TemporaryGlb file(text.binary());
    const auto mm = TestScene::parse("scene 1 length=mm\ncamera { from 0 0 5 m; look-at 0 0 0 }\n" + kSky +
                                     "shape mesh \"" + file.path() + "\" { material diffuse }");
    REQUIRE(mm.report() == "");
    CHECK(mm.built().facts.triangles == 4);
    CHECK(near(trace(mm, {0.3, 2.6, 9}, {0, 0, -1}).p, {0.3, 2.6, 1}));
    const auto zUp =
        TestScene::parse("scene 1 up=z\ncamera { from 0 -5 1 }\n" + kSky + "shape mesh \"" + file.path() + "\"");
    REQUIRE(zUp.report() == "");
    const WorldHit hit = trace(zUp, {0.3, -9, 2.6}, {0, 1, 0}); // x y z of the file are x -z y of the scene
    CHECK(near(hit.p, {0.3, -1, 2.6}));
    CHECK(near(Vec3d(hit.hit.ng), {0, -1, 0}));
    const auto one = build("shape mesh { file \"" + file.path() + "\" node=B }");
    REQUIRE(one.report() == "");
    CHECK(one.built().facts.triangles == 2);
    CHECK(near(trace(one, {5.3, 0.6, 9}, {0, 0, -1}).p, {5.3, 0.6, 0}));
    const auto none = build("shape mesh { file \"" + file.path() + "\" node=C }");
    CHECK(codes(none) == "E0402");
    CHECK(none.report().find("no node is named `C`") != std::string::npos);
}

namespace {

// A triangle that an animation lifts by a metre in the first second, and a line.
std::string liftedGlb() {
    GltfMaker m;
    const int positions = m.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0});
    const int times = m.floats("SCALAR", {0, 1}), places = m.floats("VEC3", {0, 0, 0, 0, 0, 1});
    return m.binary(
        R"([{"mesh":0}])",
        fmt::format(
            R"([{{"primitives":[{{"attributes":{{"POSITION":{0}}}}},{{"attributes":{{"POSITION":{0}}},"mode":1}}]}}])",
            positions),
        fmt::format(
            R"("animations":[{{"name":"Lift","channels":[{{"sampler":0,"target":{{"node":0,"path":"translation"}}}}],)"
            R"("samplers":[{{"input":{},"output":{}}}]}}])",
            times, places));
}

} // namespace

TEST_CASE("gltf: a pose by the time of an animation, and what is left out") {
    const TemporaryGlb file(liftedGlb());
    const auto depth = [&](const std::string& keys) {
        const auto scene = build("shape mesh { file \"" + file.path() + "\"" + keys + " }");
        CHECK(codes(scene) == "W0604");
        CHECK(scene.report().find("meshes[0].primitives[1]: lines") != std::string::npos);
        return trace(scene, {0.2, 0.2, 9}, {0, 0, -1}).p.z;
    };
    CHECK(depth("") == doctest::Approx(0));
    CHECK(depth(" time=0.25") == doctest::Approx(0.25));
    CHECK(depth(" animation=Lift time=7") == doctest::Approx(1));
    CHECK(depth(" animation=Lift") == doctest::Approx(0));
    const auto none = build("shape mesh { file \"" + file.path() + "\" animation=Fall }");
    CHECK(codes(none) == "E0402");
    CHECK(none.report().find("no animation is named `Fall`; there are 1: `Lift`") != std::string::npos);
    CHECK(codes(build("shape mesh { file \"" + file.path() + "\" time=soon }")).starts_with("E03"));
}

} // namespace abbe::test
