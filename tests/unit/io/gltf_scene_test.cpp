// What a glTF file holds besides one mesh: poses by closed forms, primitives as they are then, copies, images.
#include "gltf_maker.h"
#include "io/gltf_scene.h"
#include "temporary_folder.h"

#include <doctest/doctest.h>
#include <fstream>
#include <numbers>

using namespace abbe;
using namespace abbe::test;

namespace {

GltfDocument opened(const std::string& bytes) { return GltfDocument(bytes, "test.glb"); }

bool near(Vec3d a, Vec3d b, double most = 1e-6) { return length(a - b) < most; }
bool near(Vec3 a, Vec3d b) { return near(Vec3d(a), b); }

Vec3d movedTo(const GltfAnimation& animation, double time, int node = 0) { return animation.local(node, time).t; }

// A file with one node and one channel that moves it.
std::string animated(GltfMaker maker, const std::string& path, int input, int output, const std::string& mixing) {
    return maker.binary(R"([{"name":"A"}])", "[]",
                        fmt::format(R"("animations":[{{"name":"Walk","channels":[{{"sampler":0,"target":{{"node":0,)"
                                    R"("path":"{}"}}}}],"samplers":[{{"input":{},"output":{},)"
                                    R"("interpolation":"{}"}}]}}])",
                                    path, input, output, mixing));
}

} // namespace

TEST_CASE("gltf: translations between keys: linear, steps, cubic splines") {
    GltfMaker m;
    const int times = m.floats("SCALAR", {1, 3}), places = m.floats("VEC3", {0, 0, 0, 4, 2, 0});
    const GltfDocument linear = opened(animated(m, "translation", times, places, "LINEAR"));
    const GltfAnimation a(linear, 0);
    CHECK(a.span() == std::pair(1.0, 3.0));
    CHECK(a.moves(0));
    CHECK_FALSE(a.morphs(0));
    CHECK(near(movedTo(a, 1.5), {1, 0.5, 0}));
    CHECK(movedTo(a, -5) == Vec3d(0, 0, 0));
    CHECK(movedTo(a, 1) == Vec3d(0, 0, 0));
    CHECK(movedTo(a, 3) == Vec3d(4, 2, 0));
    CHECK(movedTo(a, 99) == Vec3d(4, 2, 0));
    CHECK(a.keyTimes(0) == std::vector<double>{1, 3});
    CHECK(GltfAnimation::named(linear, "Walk") == 0);
    CHECK(errorOf([&] { GltfAnimation::named(linear, "Run"); }).find("`Walk`") != std::string::npos);
    const GltfAnimation rest(linear, -1);
    CHECK_FALSE(rest.span());
    CHECK_FALSE(rest.moves(0));
    CHECK(movedTo(rest, 1.5) == Vec3d());

    const GltfDocument steps = opened(animated(m, "translation", times, places, "STEP"));
    const GltfAnimation b(steps, 0);
    CHECK(movedTo(b, 2.999) == Vec3d(0, 0, 0));
    CHECK(movedTo(b, 3) == Vec3d(4, 2, 0));
    REQUIRE(b.keyTimes(0).size() == 3);
    CHECK(b.keyTimes(0)[1] < 3);
    CHECK(b.keyTimes(0)[1] > 2.99);

    // At the middle of a key of length h: the mean of both values and h/8 times the difference of the tangents.
    const int spline = m.floats("VEC3", {9, 9, 9, 0, 0, 0, 1, 2, 0, -1, 4, 0, 4, 2, 0, 9, 9, 9});
    const GltfDocument cubic = opened(animated(m, "translation", times, spline, "CUBICSPLINE"));
    const GltfAnimation c(cubic, 0);
    CHECK(near(movedTo(c, 2), {2 + 2.0 / 8 * (1 - -1), 1 + 2.0 / 8 * (2 - 4), 0}));
    CHECK(movedTo(c, 1) == Vec3d(0, 0, 0));
    CHECK(movedTo(c, 3) == Vec3d(4, 2, 0));
    CHECK(movedTo(c, 7) == Vec3d(4, 2, 0));
    // The tangent at a key is what the file says, by the second.
    CHECK(near((movedTo(c, 1 + 1e-6) - movedTo(c, 1)) / 1e-6, {1, 2, 0}, 1e-4));
    CHECK(c.keyTimes(0).size() == 17);
}

TEST_CASE("gltf: rotations run along the shorter arc, also as normalised integers") {
    GltfMaker m;
    const float s = std::sqrt(0.5f);
    const int times = m.floats("SCALAR", {0, 1});
    const int turn = m.floats("VEC4", {0, 0, 0, 1, 0, 0, -s, -s}); // 90° about z, from its other quaternion
    const GltfDocument linear = opened(animated(m, "rotation", times, turn, "LINEAR"));
    const GltfAnimation a(linear, 0);
    const double third = std::numbers::pi / 6;
    CHECK(near(a.local(0, 1.0 / 3).vector({1, 0, 0}), {std::cos(third), std::sin(third), 0}));
    CHECK(near(a.local(0, 1).vector({1, 0, 0}), {0, 1, 0}));

    const int shorts =
        m.add("VEC4", 5122, 2, bytesOf<std::int16_t>({0, 0, 0, 32767, 0, 0, 23170, 23170}), ",\"normalized\":true");
    const GltfDocument packed = opened(animated(m, "rotation", times, shorts, "LINEAR"));
    CHECK(near(GltfAnimation(packed, 0).local(0, 1).vector({1, 0, 0}), {0, 1, 0}));
    // A spline through quaternions has unit length again.
    const int spline = m.floats("VEC4", {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, s, s, 0, 0, 0, 0});
    const GltfDocument cubic = opened(animated(m, "rotation", times, spline, "CUBICSPLINE"));
    const double eighth = std::numbers::pi / 4;
    CHECK(near(GltfAnimation(cubic, 0).local(0, 0.5).vector({1, 0, 0}), {std::cos(eighth), std::sin(eighth), 0}));
}

TEST_CASE("gltf: the times of keys say all that a motion with keys needs") {
    GltfMaker m;
    const float s = std::sin(1.4f), c = std::cos(1.4f); // 160° about z
    const int two = m.floats("SCALAR", {0, 2}), three = m.floats("SCALAR", {0, 0.5f, 3});
    const int turn = m.floats("VEC4", {0, 0, 0, 1, 0, 0, s, c}),
              places = m.floats("VEC3", {0, 0, 0, 1, 2, 3, -4, 0, 1});
    const int sizes = m.floats("VEC3", {1, 1, 1, 2, 3, -1, 2, 3, 1});
    const int spline = m.floats("VEC3", {0, 0, 0, 0, 0, 0, 2, 0, 1, 0, 3, 0, 1, 1, 1, 0, 0, 0});
    const auto file = [&](const std::string& placing) {
        return m.binary(
            R"([{}])", "[]",
            fmt::format(
                R"("animations":[{{"channels":[{{"sampler":0,"target":{{"node":0,"path":"rotation"}}}},)"
                R"({{"sampler":1,"target":{{"node":0,"path":"translation"}}}},)"
                R"({{"sampler":2,"target":{{"node":0,"path":"scale"}}}}],"samplers":[{{"input":{0},"output":{1}}},)"
                R"({2},{{"input":{3},"output":{4},"interpolation":"STEP"}}]}}])",
                two, turn, placing, three, sizes));
    };
    const auto largestGap = [](const GltfDocument& document) {
        const GltfAnimation animation(document, 0);
        std::vector<KeyedTransform::Key> keys;
        for (const double time : animation.keyTimes(0))
            keys.push_back({time, {{TransformStep::Kind::matrix, {}, 0, animation.local(0, time)}}});
        const KeyedTransform motion(keys);
        double largest = 0;
        for (int i = -10; i < 340; ++i) {
            const double time = 0.01 * i + 1e-3;
            for (const Vec3d p : {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)})
                largest = std::max(largest, length(motion.at(time).point(p) - animation.local(0, time).point(p)));
        }
        return largest;
    };
    CHECK(largestGap(opened(file(fmt::format(R"({{"input":{},"output":{}}})", three, places)))) < 1e-6);
    const double cubic = largestGap(
        opened(file(fmt::format(R"({{"input":{},"output":{},"interpolation":"CUBICSPLINE"}})", two, spline))));
    CHECK(cubic < 0.01);   // parts of 1/8 s are straight
    CHECK(cubic > 0.0003); // and so are no more than near
}

TEST_CASE("gltf: a pose composes scale, rotation and translation from the inside out, parents first") {
    GltfMaker m;
    const std::string nodes =
        R"([{"children":[1],"translation":[10,0,0],"rotation":[0,0,0.70710678,0.70710678]},)"
        R"({"name":"Child","scale":[2,1,1],"translation":[0,1,0],"children":[2]},{"matrix":[0,1,0,0,-1,0,0,0,0,0,1,0,5,0,0,1]},)"
        R"({"name":"Aside","translation":[0,0,7]}])";
    const GltfDocument document = opened(m.binary(nodes, "[]", R"("scenes":[{"nodes":[0]}])"));
    const GltfPose pose = GltfAnimation(document, -1).pose(0);
    REQUIRE(pose.nodes().size() == 3);
    CHECK(pose.nodes()[1].node == 1);
    CHECK(pose.nodes()[1].parent == 0);
    CHECK(pose.nodes()[0].parent == -1);
    CHECK(near(pose.nodes()[1].world.point({1, 0, 0}), {9, 2, 0})); // (2 0 0) → (2 1 0) → (-1 2 0) → (9 2 0)
    CHECK(near(pose.nodes()[2].local.point({1, 0, 0}), {5, 1, 0}));
    REQUIRE(pose.find(3)); // in no scene, and yet of the file
    CHECK(pose.find(3)->world.t == Vec3d(0, 0, 7));
    CHECK_FALSE(pose.find(4));
    CHECK_FALSE(pose.find(-1));
    CHECK(GltfAnimation(document, -1).pose(0, "Child").nodes().size() == 2);
}

TEST_CASE("gltf: a skin of two joints bent by a right angle") {
    GltfMaker m;
    const int positions = m.floats("VEC3", {0, 0, 0, 2, 0, 0, 2, 0, 0});
    const int normals = m.floats("VEC3", {0, 1, 0, 0, 1, 0, 0, 1, 0});
    const int joints = m.add("VEC4", 5121, 3, bytesOf<std::uint8_t>({0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}));
    const int weights = m.floats("VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0});
    const int inverse = m.floats(
        "MAT4", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1});
    const std::string mesh = fmt::format(R"([{{"primitives":[{{"attributes":{{"POSITION":{},"NORMAL":{},"JOINTS_0":{},)"
                                         R"("WEIGHTS_0":{}}}}}]}}])",
                                         positions, normals, joints, weights);
    // The elbow is 1 m along the upper arm; what stands above the mesh does not count.
    const std::string nodes = R"([{"children":[1],"translation":[0,0,3]},{"translation":[1,0,0],)"
                              R"("rotation":[0,0,0.70710678,0.70710678]},{"mesh":0,"skin":0,"translation":[100,0,0]}])";
    const std::string skin = fmt::format(R"("skins":[{{"joints":[0,1],"inverseBindMatrices":{}}}])", inverse);
    const std::string file = m.binary(nodes, mesh, skin);
    const GltfDocument document = opened(file);
    const GltfPrimitive p = gltfPrimitive(document, GltfAnimation(document, -1).pose(0), 2, 0);
    CHECK(p.skinned);
    REQUIRE(p.mesh.positions.size() == 3);
    CHECK(near(p.mesh.positions[0], {0, 0, 3}));
    CHECK(near(p.mesh.positions[1], {1, 1, 3}));
    CHECK(near(p.mesh.positions[2], {1.5, 0.5, 3})); // the mean of the straight and the bent one
    CHECK(near(p.mesh.normals[1], {-1, 0, 0}));
    CHECK(near(parseGltf(file, "a.glb").mesh.positions[1], {1, 1, 3})); // and so in one mesh of all
    CHECK(near(parseGltf(file, "a.glb", {.node = "", .mesh = ""}).mesh.normals[2], Vec3d(-1, 1, 0) / std::sqrt(2.0)));
    // Without matrices the mesh is in the space of each joint.
    const GltfDocument plain = opened(m.binary(nodes, mesh, R"("skins":[{"joints":[0,1]}])"));
    CHECK(near(gltfPrimitive(plain, GltfAnimation(plain, -1).pose(0), 2, 0).mesh.positions[1], {1, 2, 3}));
    // Faults, each at its place.
    const auto fault = [&](const std::string& withSkin) {
        return errorOf([&] { parseGltf(m.binary(nodes, mesh, withSkin), "a.glb"); });
    };
    CHECK(fault(R"("skins":[{"joints":[0]}])").find("JOINTS_0: vertex 1 is at joint 1 of 1") != std::string::npos);
    CHECK(fault(R"("skins":[{"joints":[0,9]}])").find("skins[0].joints[1] is 9") != std::string::npos);
    CHECK(fault(R"("skins":[])").find("nodes[2].skin is 0, but there are 0") != std::string::npos);
    CHECK(fault(fmt::format(R"("skins":[{{"joints":[0,1,0],"inverseBindMatrices":{}}}])", inverse))
              .find("2 matrices for 3 joints") != std::string::npos);
}

TEST_CASE("gltf: eight joints of two sets count") {
    GltfMaker m;
    const int positions = m.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0});
    const int first = m.add("VEC4", 5123, 3, bytesOf<std::uint16_t>({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
    const int second = m.add("VEC4", 5123, 3, bytesOf<std::uint16_t>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}));
    const int weights =
        m.add("VEC4", 5121, 3, bytesOf<std::uint8_t>({51, 0, 0, 0, 51, 0, 0, 0, 51, 0, 0, 0}), ",\"normalized\":true");
    const int others = m.add("VEC4", 5121, 3, bytesOf<std::uint8_t>({204, 0, 0, 0, 204, 0, 0, 0, 204, 0, 0, 0}),
                             ",\"normalized\":true");
    const std::string mesh =
        fmt::format(R"([{{"primitives":[{{"attributes":{{"POSITION":{},"JOINTS_0":{},"WEIGHTS_0":{},)"
                    R"("JOINTS_1":{},"WEIGHTS_1":{}}}}}]}}])",
                    positions, first, weights, second, others);
    const std::string nodes = R"([{},{"translation":[10,0,0]},{"mesh":0,"skin":0}])";
    const MeshFile file = parseGltf(m.binary(nodes, mesh, R"("skins":[{"joints":[0,1]}])"), "a.glb");
    CHECK(near(file.mesh.positions[0], {8, 0, 0}));
    CHECK(near(file.mesh.positions[1], {9, 0, 0}));
}

TEST_CASE("gltf: morph targets at their weights, dense and sparse, at rest and animated") {
    GltfMaker m;
    const int positions = m.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0}),
              normals = m.floats("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1});
    const int lifted = m.floats("VEC3", {0, 0, 4, 0, 0, 8, 0, 0, 0}),
              tilted = m.floats("VEC3", {0, 4, -4, 0, 0, 0, 0, 0, 0});
    const int where = m.view(bytesOf<std::uint16_t>({2, 0})), what = m.view(bytesOf<float>({10, 0, 0}));
    const int sparse =
        m.raw(fmt::format(R"({{"componentType":5126,"count":3,"type":"VEC3","sparse":{{"count":1,"indices":)"
                          R"({{"bufferView":{},"componentType":5123}},"values":{{"bufferView":{}}}}}}})",
                          where, what));
    const std::string mesh =
        fmt::format(R"([{{"weights":[0,0],"primitives":[{{"attributes":{{"POSITION":{},"NORMAL":{}}},"targets":[)"
                    R"({{"POSITION":{},"NORMAL":{}}},{{"POSITION":{}}}]}}]}}])",
                    positions, normals, lifted, tilted, sparse);
    const int times = m.floats("SCALAR", {0, 2}), weights = m.floats("SCALAR", {0, 0, 0.5f, 1});
    const std::string animation =
        fmt::format(R"("animations":[{{"channels":[{{"sampler":0,"target":{{"node":0,"path":"weights"}}}}],)"
                    R"("samplers":[{{"input":{},"output":{}}}]}}])",
                    times, weights);
    const std::string file = m.binary(R"([{"mesh":0,"weights":[0.25,0]}])", mesh, animation);
    const MeshFile rest = parseGltf(file, "a.glb");
    CHECK(near(rest.mesh.positions[0], {0, 0, 1}));
    CHECK(near(rest.mesh.positions[1], {1, 0, 2}));
    CHECK(near(rest.mesh.positions[2], {0, 1, 0}));
    CHECK(near(rest.mesh.normals[0], {0, 1, 0})); // (0 0 1) + 0.25 (0 4 -4)
    const MeshFile midway = parseGltf(file, "a.glb", {.node = "", .mesh = "", .animation = "", .time = 1.0});
    CHECK(near(midway.mesh.positions[0], {0, 0, 1}));
    CHECK(near(midway.mesh.positions[2], {5, 1, 0}));
    const GltfDocument document = opened(file);
    const GltfAnimation a(document, 0);
    CHECK(a.morphs(0));
    CHECK_FALSE(a.moves(0));
    CHECK(a.weights(0, 1) == std::vector<double>{0.25, 0.5});
    CHECK(a.weightTimes(0) == std::vector<double>{0, 2});
    CHECK(a.keyTimes(0).empty());
    // The mesh's own weights where a node has none.
    CHECK(near(parseGltf(m.binary(R"([{"mesh":0}])", mesh, ""), "a.glb").mesh.positions[0], {0, 0, 0}));
    CHECK(errorOf([&] {
              parseGltf(m.binary(R"([{"mesh":0}])", mesh, ""), "a",
                        {.node = "", .mesh = "", .animation = "", .time = 1.0});
          }).find("no animation") != std::string::npos);
}

TEST_CASE("gltf: copies of a node, each within the node") {
    GltfMaker m;
    const int positions = m.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0});
    const int places = m.floats("VEC3", {0, 0, 0, 3, 0, 0}), sizes = m.floats("VEC3", {1, 1, 1, 2, 2, 2});
    const int turns =
        m.add("VEC4", 5120, 2, bytesOf<std::int8_t>({0, 0, 0, 127, 0, 0, 127, 0}), ",\"normalized\":true");
    const std::string mesh = fmt::format(R"([{{"primitives":[{{"attributes":{{"POSITION":{}}}}}]}}])", positions);
    const auto nodes = [](const std::string& attributes) {
        return R"([{"mesh":0,"translation":[0,0,5],"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{)" +
               attributes + "}}}}]";
    };
    const std::string required = R"("extensionsRequired":["EXT_mesh_gpu_instancing"])";
    const std::string three = fmt::format(R"("TRANSLATION":{},"ROTATION":{},"SCALE":{},"_ID":0)", places, turns, sizes);
    const MeshFile file = parseGltf(m.binary(nodes(three), mesh, required), "a.glb");
    REQUIRE(file.mesh.positions.size() == 6);
    CHECK(near(file.mesh.positions[1], {1, 0, 5}));
    CHECK(near(file.mesh.positions[4], {1, 0, 5})); // (1 0 0) → twice → turned by 180° about z → (-2 0 0) → (1 0 0)
    CHECK(near(file.mesh.positions[5], {3, -2, 5}));
    CHECK(file.groups.size() == 1);
    CHECK(file.groups[0].triangleCount == 2);
    const std::string uneven = fmt::format(R"("TRANSLATION":{},"SCALE":{})", places, positions);
    CHECK(errorOf([&] {
              parseGltf(m.binary(nodes(uneven), mesh, ""), "a.glb");
          }).find("SCALE: 3 values for 2 copies") != std::string::npos);
    const GltfDocument plain = opened(m.binary(R"([{"mesh":0}])", mesh, ""));
    CHECK(gltfInstances(plain, 0).size() == 1);
}

TEST_CASE("gltf: colours, second texture coordinates, tangents; points and lines by name") {
    GltfMaker m;
    const int positions = m.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0}),
              normals = m.floats("VEC3", {0, 0, 2, 0, 0, 2, 0, 0, 2});
    const int colors = m.add("VEC4", 5121, 3, bytesOf<std::uint8_t>({255, 0, 0, 255, 0, 255, 0, 51, 0, 0, 255, 0}),
                             ",\"normalized\":true");
    const int uv = m.floats("VEC2", {0, 0.25f, 0, 0, 0, 0}),
              tangents = m.floats("VEC4", {2, 0, 0, -1, 1, 0, 0, 1, 1, 0, 0, 1});
    const std::string mesh = fmt::format(
        R"([{{"primitives":[{{"attributes":{{"POSITION":{0},"NORMAL":{1},"COLOR_0":{2},"TEXCOORD_1":{3},"TANGENT":{4}}}}},)"
        R"({{"attributes":{{"POSITION":{0}}},"mode":0}},{{"attributes":{{"POSITION":{0}}},"mode":3}},)"
        R"({{"attributes":{{"POSITION":{0}}}}}]}}])",
        positions, normals, colors, uv, tangents);
    const std::string file = m.binary(R"([{"mesh":0}])", mesh, "");
    const GltfDocument document = opened(file);
    const GltfPose pose = GltfAnimation(document, -1).pose(0);
    const GltfPrimitive p = gltfPrimitive(document, pose, 0, 0);
    REQUIRE(p.mesh.attributes.size() == 2);
    CHECK(p.mesh.attributes[0].name == "color");
    CHECK(p.mesh.attributes[0].values == std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 1});
    CHECK(p.mesh.attributes[1].values == std::vector<float>{1, 0.2f, 0});
    CHECK(p.mesh.normals[0] == Vec3(0, 0, 1));
    CHECK(p.mesh.uvs.empty());
    REQUIRE(p.uvs1.size() == 3);
    CHECK(p.uvs1[0] == Vec2{0, 0.75f});
    CHECK(p.tangents[0] == std::array<float, 4>{1, 0, 0, -1});
    CHECK_FALSE(p.skinned);
    CHECK(gltfPrimitive(document, pose, 0, 1).leftOut == "points");
    CHECK(gltfPrimitive(document, pose, 0, 2).leftOut == "lines");
    CHECK(errorOf([&] { gltfPrimitive(document, pose, 0, 4); }) != "");
    const MeshFile all = parseGltf(file, "a.glb");
    CHECK(all.leftOut == std::vector<std::string>{"meshes[0].primitives[1]: points", "meshes[0].primitives[2]: lines"});
    REQUIRE(all.mesh.attributes.size() == 2);
    CHECK(all.mesh.attributes[0].values.size() == 18);
    CHECK(all.mesh.attributes[0].values[9] == 1); // the one without colours is white
}

TEST_CASE("gltf: what an animation moves that is no node is named") {
    GltfMaker m;
    const int times = m.floats("SCALAR", {0, 1}), places = m.floats("VEC3", {0, 0, 0, 1, 0, 0});
    const auto channel = [&](const std::string& target, const std::string& sampler = "") {
        return m.binary(
            R"([{"name":"A"},{"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}])", "[]",
            fmt::format(R"("extensionsUsed":["KHR_animation_pointer"],"animations":[{{"channels":[{{"sampler":0,)"
                        R"("target":{{{}}}}}],"samplers":[{{"input":{},"output":{}{}}}]}}])",
                        target, times, places, sampler));
    };
    const auto fault = [&](const std::string& file) {
        return errorOf([&] {
            const GltfDocument document = opened(file);
            GltfAnimation(document, 0);
        });
    };
    const GltfDocument document = opened(channel(
        R"("path":"pointer","extensions":{"KHR_animation_pointer":{"pointer":"/materials/0/emissiveFactor"}})"));
    const GltfAnimation a(document, 0);
    REQUIRE(a.leftOut().size() == 1);
    CHECK(a.leftOut()[0].starts_with("animations[0].channels[0]: "));
    CHECK(fault(channel(R"("node":0,"path":"translation")")) == "");
    CHECK(fault(channel(R"("node":5,"path":"translation")")).find("target.node is 5") != std::string::npos);
    CHECK(fault(channel(R"("node":1,"path":"translation")")).find("has a matrix") != std::string::npos);
    CHECK(fault(channel(R"("node":0,"path":"rotation")")).find("3 components instead of 4") != std::string::npos);
    CHECK(fault(channel(R"("node":0,"path":"weights")")).find("samplers[0].output") != std::string::npos);
    CHECK(fault(channel(R"("node":0,"path":"scale")", R"(,"interpolation":"CUBICSPLINE")")).find("which take 6") !=
          std::string::npos);
    CHECK(fault(channel(R"("node":0,"path":"scale")", R"(,"interpolation":"BEZIER")")).find("`BEZIER`") !=
          std::string::npos);
    GltfMaker n;
    const int twice = n.floats("SCALAR", {1, 1}), two = n.floats("VEC3", {0, 0, 0, 1, 0, 0});
    CHECK(fault(animated(n, "scale", twice, two, "LINEAR")).find("key 1 is not after") != std::string::npos);
}

TEST_CASE("gltf: images are embedded or beside the file") {
    GltfMaker m;
    const int png = m.view("\x89PNG rest of it");
    const std::string images = fmt::format(
        R"("images":[{{"bufferView":{},"mimeType":"image/jpeg"}},{{"uri":"data:image/jpeg;base64,/9j/AAAA"}},)"
        R"({{"uri":"data:image/webp;base64,UklGRgAAAABXRUJQ"}},{{"uri":"maps/a%20b.PNG"}},{{"uri":"https://x.org/a.png"}},)"
        R"({{"uri":"data:image/ktx2,text"}}])",
        png);
    const TemporaryFolder folder;
    const std::string bytes = m.binary("[]", "[]", images);
    const GltfDocument document(bytes, folder / "a.glb");
    const GltfImage view = gltfImage(document, 0);
    CHECK(view.extension == ".png"); // by its bytes
    CHECK(view.bytes.starts_with("\x89PNG rest"));
    CHECK(gltfImage(document, 1).extension == ".jpg");
    CHECK(gltfImage(document, 1).bytes.size() == 6);
    CHECK(gltfImage(document, 2).extension == ".webp");
    CHECK(gltfImage(document, 2).bytes == std::string("RIFF\0\0\0\0WEBP", 12));
    const GltfImage beside = gltfImage(document, 3);
    CHECK(beside.extension == ".png");
    CHECK(beside.bytes.empty());
    CHECK(beside.file == std::filesystem::path(folder / "maps/a b.PNG"));
    CHECK(errorOf([&] { gltfImage(document, 4); }).find("images[4].uri") != std::string::npos);
    CHECK(errorOf([&] { gltfImage(document, 5); }).find("images[5].uri") != std::string::npos);
    CHECK(errorOf([&] { gltfImage(document, 6); }).find("there are 6") != std::string::npos);
}
