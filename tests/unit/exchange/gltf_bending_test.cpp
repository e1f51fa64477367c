// Skins and morph targets of glTF that move: where their points are while the shutter is open, worked out by hand.
#include "film/film_layers.h"
#include "unit/exchange/gltf_cases.h"

#include <cmath>
#include <doctest/doctest.h>

using namespace abbe;
using namespace abbe::exchange;

namespace {

// Positions of a plate from (1, -1/2) to (3, 1/2) in the plane z = 0, the same joint for all corners, the times 0 and
// 1 s, turns by 0 and 90° about z, a morph target that lifts the plate by 1 m, weights 0 and 1, ways of 0 and 4 m
// along y, and 8 weights of STEP at the times 0, 1 and 2 s: 0, 1, 1.
std::string bendingBuffer() {
    const float half = static_cast<float>(std::sqrt(0.5));
    const std::vector<float> numbers = {1, -.5f, 0, 3, -.5f, 0, 3,    .5f,  0, 1, .5f, 0,             // 0
                                        1, 0,    0, 0, 1,    0, 0,    0,    1, 0, 0,   0, 1, 0, 0, 0, // 48
                                        0, 1,                                                         // 112
                                        0, 0,    0, 1, 0,    0, half, half,                           // 120
                                        0, 0,    1, 0, 0,    1, 0,    0,    1, 0, 0,   1,             // 152
                                        0, 1,                                                         // 200
                                        0, 0,    0, 0, 4,    0,                                       // 208
                                        0, 1,    2, 0, 1,    1};                                      // 232
    const std::vector<std::uint16_t> corners = {0, 1, 2, 0, 2, 3};                                    // 256
    std::string bytes(numbers.size() * 4, '\0');
    std::memcpy(bytes.data(), numbers.data(), bytes.size());
    bytes.append(reinterpret_cast<const char*>(corners.data()), 12); // and 16 joints, all 0: 268
    return bytes + std::string(16, '\0');
}

struct BendingCase : GltfCase {
    // `nodes`: the camera is node 0, what stands in the scene are the nodes 0 and 1.
    BendingCase(const std::string& nodes, const std::string& animation, const std::string& primitive = "") {
        writeAll(folder / "bend.bin", bendingBuffer());
        const auto accessor = [](int offset, int type, int count, const char* shape) {
            return "{\"bufferView\":0,\"byteOffset\":" + std::to_string(offset) +
                   ",\"componentType\":" + std::to_string(type) + ",\"count\":" + std::to_string(count) +
                   ",\"type\":\"" + shape + "\"}";
        };
        import(R"({"asset":{"version":"2.0"},"scene":0,"buffers":[{"uri":"bend.bin","byteLength":284}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":284}],"accessors":[)" +
               accessor(0, 5126, 4, "VEC3") + "," + accessor(48, 5126, 4, "VEC4") + "," +
               accessor(112, 5126, 2, "SCALAR") + "," + accessor(120, 5126, 2, "VEC4") + "," +
               accessor(152, 5126, 4, "VEC3") + "," + accessor(200, 5126, 2, "SCALAR") + "," +
               accessor(208, 5126, 2, "VEC3") + "," + accessor(256, 5123, 6, "SCALAR") + "," +
               accessor(268, 5121, 4, "VEC4") + "," + accessor(232, 5126, 3, "SCALAR") + "," +
               accessor(244, 5126, 3, "SCALAR") + R"(],
"cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":1}}],"materials":[{"name":"skin","emissiveFactor":[1,0,0]}],
"meshes":[{"name":"plate","primitives":[{"attributes":{"POSITION":0,"JOINTS_0":8,"WEIGHTS_0":1},"indices":7,"material":0)" +
               primitive + R"(}]}],"scenes":[{"nodes":[0,1]}],
"nodes":[{"name":"eye","camera":0,"translation":[0,0,20]},)" +
               nodes + R"(],"animations":[)" + animation + "]}");
    }

    // With the shutter open from `open` to `close` (s).
    test::TestScene seen(double open, double close) const {
        std::string text = scene;
        const std::size_t camera = text.find("camera eye {");
        REQUIRE(camera != std::string::npos);
        text.insert(camera + 12,
                    " time " + std::to_string(open) + " s; shutter " + std::to_string(close - open) + " s; ");
        writeAll(folder / "case.scene", text);
        return test::TestScene::load(folder / "case.scene");
    }
};

// How high the first thing is at (x, y) at a share of the shutter's time; -1 where there is nothing.
double heightAt(const test::TestScene& scene, double x, double y, double share) {
    SurfaceHit hit;
    const Ray ray{Vec3(Vec3d{x, y, 10} - scene.scene().origin), {0, 0, -1}, kInfinity, static_cast<float>(share)};
    return scene.scene().intersector->intersect(ray, hit) ? 10 - static_cast<double>(hit.distance) : -1;
}

// Whether the plate stands turned by `degrees`: its far corner (3, 1/2) is where it should be, to 1 %.
bool stands(const test::TestScene& scene, double degrees, double share, Vec3d moved = {}) {
    const double c = std::cos(degrees * kPiD / 180), s = std::sin(degrees * kPiD / 180);
    const auto hits = [&](double x, double y) {
        return heightAt(scene, c * x - s * y + moved.x, s * x + c * y + moved.y, share) > -1;
    };
    return hits(2.98, 0.48) && !hits(3.02, 0.48) && !hits(2.98, 0.52) && hits(1.02, -0.48) && !hits(0.98, -0.48);
}

const char* const kTurning =
    R"({"channels":[{"sampler":0,"target":{"node":2,"path":"rotation"}}],"samplers":[{"input":2,"output":3}]})";

} // namespace

TEST_CASE("glTF: a skin bends while the shutter is open") {
    const BendingCase made(R"({"mesh":0,"skin":0,"name":"arm"},{"name":"bone"}],"skins":[{"joints":[2]})", kTurning);
    INFO(made.report());
    INFO(made.scene);
    CHECK(made.has("shape arm mesh { material skin; at 0 s { file \"case-files/arm.ply\" }"));
    CHECK(made.has("at 0.5 s { file"));
    CHECK(made.has("at 1 s { file"));
    CHECK_FALSE(made.says("stand still"));
    CHECK(made.says("what material `skin` emits is left out: it is bent"));
    // A quarter and three quarters of the turn by 90°, and in between; with keys every 90°/32 the middle of a chord is
    // 3 (1 - cos 1.4°) = 0.9 mm inside of the circle.
    const auto scene = made.seen(0.25, 0.75);
    INFO(scene.report());
    REQUIRE_FALSE(scene.diagnostics().hasErrors());
    CHECK(stands(scene, 22.5, 0));
    CHECK(stands(scene, 67.5, 1));
    CHECK(stands(scene, 22.5 + 45 * 0.3, 0.3));
    CHECK_FALSE(stands(scene, 22.5, 1));
    CHECK(stands(made.seen(-2, -1), 0, 1)); // before the first key
    CHECK(stands(made.seen(5, 6), 90, 0));
}

TEST_CASE("glTF: a skin moves with what its joints hang on") {
    const BendingCase made(R"({"mesh":0,"skin":0,"name":"arm"},{"name":"body","children":[3]},{"name":"bone"}],
"skins":[{"joints":[3]})",
                           R"({"channels":[{"sampler":0,"target":{"node":2,"path":"translation"}}],
"samplers":[{"input":2,"output":6}]})");
    INFO(made.report());
    INFO(made.scene);
    CHECK(
        made.has("material skin; at 0 s { file \"case-files/arm.ply\" }; at 1 s { file \"case-files/arm-2.ply\" } }"));
    const auto scene = made.seen(0.25, 0.75);
    INFO(scene.report());
    REQUIRE_FALSE(scene.diagnostics().hasErrors());
    CHECK(stands(scene, 0, 0, {0, 1, 0}));
    CHECK(stands(scene, 0, 1, {0, 3, 0}));
}

TEST_CASE("glTF: morph targets move, and only where they are animated") {
    const std::string targets = R"(,"targets":[{"POSITION":4}])";
    const BendingCase made(
        R"({"children":[2,3]},{"mesh":0,"name":"lid"},{"mesh":0,"name":"floor","translation":[0,-5,0]})",
        R"({"channels":[{"sampler":0,"target":{"node":2,"path":"weights"}}],
"samplers":[{"input":2,"output":5}]})",
        targets);
    INFO(made.report());
    INFO(made.scene);
    CHECK(made.has("shape lid mesh { material skin; at 0 s { file"));
    CHECK_FALSE(made.has("at 0.5 s")); // straight ways have two keys
    const auto scene = made.seen(0.25, 0.75);
    INFO(scene.report());
    REQUIRE_FALSE(scene.diagnostics().hasErrors());
    CHECK(heightAt(scene, 2, 0.1, 0) == doctest::Approx(0.25).epsilon(1e-5));
    CHECK(heightAt(scene, 2, 0.1, 0.5) == doctest::Approx(0.5).epsilon(1e-5));
    CHECK(heightAt(scene, 2, 0.1, 1) == doctest::Approx(0.75).epsilon(1e-5));
    CHECK(heightAt(scene, 2, -4.9, 1) == doctest::Approx(0).epsilon(1e-5));
}

TEST_CASE("glTF: steps of morph targets last, and what lasts has no keys between") {
    const BendingCase made(R"({"mesh":0,"name":"lid"})",
                           R"({"channels":[{"sampler":0,"target":{"node":1,"path":"weights"}}],
"samplers":[{"input":9,"output":10,"interpolation":"STEP"}]})",
                           R"(,"targets":[{"POSITION":4}])");
    INFO(made.report());
    INFO(made.scene);
    CHECK(made.has("at 0.9999 s { file"));
    CHECK(made.has("at 1 s { file"));
    CHECK_FALSE(made.has("at 1.5"));
    const auto scene = made.seen(0.5, 1.5);
    INFO(scene.report());
    CHECK(heightAt(scene, 2, 0.1, 0.4) == doctest::Approx(0).epsilon(1e-5));
    CHECK(heightAt(scene, 2, 0.1, 0.6) == doctest::Approx(1).epsilon(1e-5));
}

TEST_CASE("glTF: the keys of what bends are bounded") {
    // 2000 nodes with one skinned mesh, each of which has keys of its own for a turn
    std::string nodes = R"({"children":[2)";
    for (int i = 4; i < 2004; ++i) nodes += "," + std::to_string(i);
    nodes += R"(]},{"name":"bone"},{})";
    for (int i = 4; i < 2004; ++i) nodes += R"(,{"mesh":0,"skin":0})";
    const BendingCase made(nodes + R"(],"skins":[{"joints":[2]})", kTurning);
    INFO(made.report());
    CHECK(made.says("the keys of meshes that bend"));
}
