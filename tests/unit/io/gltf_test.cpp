// glTF files that are sound: what of them becomes a mesh or a camera.
#include "gltf_support.h"
#include "temporary_folder.h"

#include <doctest/doctest.h>
#include <fstream>

using namespace abbe;
using namespace abbe::test;

namespace {

using Triangle = std::array<std::uint32_t, 3>;

std::string base64(const std::string& bytes) {
    static const char* const digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t v = 0;
        const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
        for (std::size_t k = 0; k < 3; ++k) v = v << 8 | (k < n ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) out += k <= n ? digits[v >> (18 - 6 * k) & 63] : '=';
    }
    return out;
}

bool close(Vec3 a, Vec3 b) { return length(a - b) < 1e-6f; }

} // namespace

TEST_CASE("gltf: a square with normals and texture coordinates") {
    const MeshFile file = GltfText().mesh();
    CHECK(file.mesh.positions == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
    CHECK(file.mesh.normals == std::vector<Vec3>(4, Vec3(0, 0, 1)));
    CHECK(file.mesh.uvs == std::vector<Vec2>{{0, 0}, {1, 0}, {1, 1}, {0, 1}}); // v runs upwards, as in OBJ
    CHECK(file.mesh.triangles == std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}});
    REQUIRE(file.groups.size() == 1);
    CHECK(file.groups[0].name == "Square");
    CHECK(file.groups[0].triangleCount == 2);
    CHECK(file.coordinates == MeshCoordinates::metresYUp);
}

TEST_CASE("gltf: buffers inside the JSON and beside it are the same") {
    GltfText text;
    const MeshFile expected = text.mesh();
    text.uri = "data:application/octet-stream;base64," + base64(text.data);
    CHECK(parseGltf(text.json(), "a.gltf").mesh.positions == expected.mesh.positions);
    const TemporaryFolder folder;
    text.uri = "the%20data.bin";
    std::ofstream(folder / "the data.bin", std::ios::binary) << text.data;
    std::ofstream(folder / "a.gltf") << text.json();
    CHECK(readMesh((folder / "a.gltf")).mesh.triangles == expected.mesh.triangles);
    std::ofstream(folder / "a.glb", std::ios::binary) << GltfText().binary();
    CHECK(readMesh((folder / "a.glb")).mesh.positions == expected.mesh.positions);
    // A buffer that is not there, or not of its length, is named.
    text.uri = "missing.bin";
    std::ofstream(folder / "b.gltf") << text.json();
    CHECK(errorOf([&] { readGltf(folder / "b.gltf"); }).find("missing.bin") != std::string::npos);
    text.uri = "the%20data.bin";
    text.data += "more";
    std::ofstream(folder / "c.gltf") << text.json();
    CHECK(errorOf([&] { readGltf(folder / "c.gltf"); }) != "");
}

TEST_CASE("gltf: indices of three sizes, none, strips and fans") {
    GltfText text;
    const auto indices = [&](int type, const std::string& bytes, int count) {
        text = GltfText();
        text.data = squareData().substr(0, 128) + bytes;
        text.views.replace(text.views.find("\"byteLength\":12"), 15, fmt::format("\"byteLength\":{}", bytes.size()));
        const std::string from = R"("componentType":5123,"count":6)";
        text.accessors.replace(text.accessors.find(from), from.size(),
                               fmt::format(R"("componentType":{},"count":{})", type, count));
    };
    const std::vector<Triangle> two{{0, 1, 2}, {0, 2, 3}};
    indices(5121, bytesOf<std::uint8_t>({0, 1, 2, 0, 2, 3}), 6);
    CHECK(text.mesh().mesh.triangles == two);
    indices(5125, bytesOf<std::uint32_t>({0, 1, 2, 0, 2, 3}), 6);
    CHECK(text.mesh().mesh.triangles == two);
    indices(5121, bytesOf<std::uint8_t>({0, 1, 3, 2}), 4);
    text.primitive.insert(1, R"("mode":5,)");
    CHECK(text.mesh().mesh.triangles == std::vector<Triangle>{{0, 1, 3}, {1, 2, 3}});
    indices(5121, bytesOf<std::uint8_t>({0, 1, 2, 3}), 4);
    text.primitive.insert(1, R"("mode":6,)");
    CHECK(text.mesh().mesh.triangles == std::vector<Triangle>{{1, 2, 0}, {2, 3, 0}});
    text = GltfText();
    text.primitive = R"({"attributes":{"POSITION":0},"mode":6})";
    CHECK(text.mesh().mesh.triangles.size() == 2);
    CHECK(text.mesh().mesh.normals.empty());
    CHECK(text.mesh().mesh.uvs.empty());
    text.primitive = R"({"attributes":{"POSITION":0},"mode":1})"; // lines
    CHECK(text.mesh().mesh.triangles.empty());
    CHECK(text.mesh().ignoredFaces == 1);
}

TEST_CASE("gltf: nodes place their meshes, and mirrors keep the outside outside") {
    GltfText text;
    text.nodes =
        R"([{"name":"Top","children":[1,2],"translation":[10,0,0]},)"
        R"({"name":"Turned","mesh":0,"rotation":[0,0,0.70710678,0.70710678],"scale":[2,1,1],"translation":[0,1,0]},)"
        R"({"name":"Mirror","mesh":0,"matrix":[-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,5,1]}])";
    const MeshFile file = text.mesh();
    REQUIRE(file.mesh.positions.size() == 8);
    CHECK(close(file.mesh.positions[1], {10, 3, 0})); // (1 0 0) → scale (2 0 0) → turn (0 2 0) → (0 3 0) → (10 3 0)
    CHECK(close(file.mesh.positions[2], {9, 3, 0}));
    CHECK(close(file.mesh.positions[5], {9, 0, 5}));
    CHECK(file.mesh.triangles[2] == Triangle{4, 6, 5});
    CHECK(close(file.mesh.normals[5], {0, 0, 1}));
    const auto& p = file.mesh.positions;
    CHECK(cross(p[6] - p[4], p[5] - p[4]).z > 0);
    // One node alone, with all that is above it; one mesh alone; names that are not there.
    const MeshFile one = text.mesh({.node = "Mirror", .mesh = ""});
    CHECK(one.mesh.positions.size() == 4);
    CHECK(close(one.mesh.positions[1], {9, 0, 5}));
    CHECK(text.mesh({.node = "", .mesh = "Plate"}).mesh.positions.size() == 8);
    CHECK(errorOf(text, {.node = "Bottom", .mesh = ""}).find("no node is named `Bottom`") != std::string::npos);
    CHECK(errorOf(text, {.node = "", .mesh = "Cup"}).find("`Cup`") != std::string::npos);
    // Without scenes all roots count.
    text.scene = "";
    CHECK(text.mesh().mesh.positions.size() == 8);
}

TEST_CASE("gltf: strides, normalised integers, sparse values") {
    GltfText text;
    text.more = R"(,"extensionsUsed":["KHR_mesh_quantization"],"extensionsRequired":["KHR_mesh_quantization"])";
    text.primitive = R"({"attributes":{"POSITION":0}})";
    text.accessors = R"([{"bufferView":0,"componentType":5122,"normalized":true,"count":3,"type":"VEC3"}])";
    text.views = R"([{"buffer":0,"byteLength":24,"byteStride":8}])";
    text.data = bytesOf<std::int16_t>({0, 0, 0, 99, 32767, 0, 0, 99, 0, -32767, 0, 99});
    CHECK(text.mesh().mesh.positions == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, -1, 0}});

    text = GltfText();
    text.primitive = R"({"attributes":{"POSITION":0},"indices":1})";
    text.accessors = R"([{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","sparse":{"count":1,)"
                     R"("indices":{"bufferView":2,"componentType":5123},"values":{"bufferView":3}}},)"
                     R"({"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}])";
    text.views = R"([{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":128,"byteLength":12},)"
                 R"({"buffer":0,"byteOffset":140,"byteLength":2},{"buffer":0,"byteOffset":144,"byteLength":12}])";
    text.data = squareData() + bytesOf<std::uint16_t>({2, 0}) + bytesOf<float>({5, 6, 7});
    CHECK(text.mesh().mesh.positions == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {5, 6, 7}, {0, 1, 0}});
    const std::string base = R"({"bufferView":0,"componentType":5126,"count":4)";
    text.accessors.replace(text.accessors.find(base), base.size(), R"({"componentType":5126,"count":4)");
    CHECK(text.mesh().mesh.positions == std::vector<Vec3>{{0, 0, 0}, {0, 0, 0}, {5, 6, 7}, {0, 0, 0}});
}

TEST_CASE("gltf: cameras with their places") {
    GltfText text;
    text.nodes = R"([{"mesh":0,"children":[1]},{"name":"Eye","camera":0,"translation":[0,0,3],"children":[2]},)"
                 R"({"camera":1,"translation":[1,0,0]}])";
    text.more = R"(,"cameras":[{"type":"perspective","perspective":{"yfov":0.5,"aspectRatio":1.5,"znear":0.1}},)"
                R"({"name":"Plan","type":"orthographic","orthographic":{"xmag":2,"ymag":1,"znear":0.1,"zfar":9}}])";
    const auto cameras = parseGltfCameras(text.binary(), "a.glb");
    REQUIRE(cameras.size() == 2);
    CHECK(cameras[0].name == "Eye");
    CHECK(cameras[0].perspective);
    CHECK(cameras[0].verticalFov == doctest::Approx(0.5));
    CHECK(cameras[0].aspect == doctest::Approx(1.5));
    CHECK(cameras[0].far == 0);
    CHECK(cameras[0].placement.t == Vec3d(0, 0, 3));
    CHECK(cameras[1].name == "Plan");
    CHECK_FALSE(cameras[1].perspective);
    CHECK(cameras[1].halfWidth == 2);
    CHECK(cameras[1].halfHeight == 1);
    CHECK(cameras[1].placement.t == Vec3d(1, 0, 3));
    text.more = R"(,"cameras":[{"type":"perspective","perspective":{"yfov":-1,"znear":0.1}}])";
    CHECK(errorOf([&] { parseGltfCameras(text.binary(), "a.glb"); }).find("yfov") != std::string::npos);
}

TEST_CASE("gltf: images and their files are not looked for") {
    GltfText text;
    text.more = R"(,"images":[{"uri":"not there.png"}],"textures":[{"source":0}],)"
                R"("materials":[{"name":"Red","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}])";
    text.primitive.insert(1, R"("material":0,)");
    CHECK(text.mesh().groups[0].material == "Red");
}
