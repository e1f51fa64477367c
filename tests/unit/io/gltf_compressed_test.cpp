// glTF geometry compressed by Draco and meshopt: what their own encoders write comes back, and damage is an error.
#include "gltf_maker.h"
#include "support/nightly.h"
#include "support/statistics.h"

#include <algorithm>
#include <cstdlib>
#include <doctest/doctest.h>
#include <draco/attributes/point_attribute.h>
#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>
#include <meshoptimizer.h>

using namespace abbe;
using namespace abbe::test;

namespace {

constexpr int kSide = 9; // vertices of a wavy square in one direction

struct Wave {
    std::vector<Vec3> positions;
    std::vector<std::uint8_t> colors; // four each
    std::vector<Vec3> normals;
    std::vector<Vec2> uvs;
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

Wave wave() {
    Wave w;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
            const float u = static_cast<float>(x) / (kSide - 1), v = static_cast<float>(y) / (kSide - 1);
            w.positions.emplace_back(u, v, 0.1f * std::sin(9 * u + 5 * v));
            w.normals.push_back(normalize(Vec3(-0.9f * std::cos(9 * u + 5 * v), -0.5f * std::cos(9 * u + 5 * v), 1)));
            w.uvs.push_back({u, v});
            for (const int c : {x * 28, y * 28, 128, 255}) w.colors.push_back(static_cast<std::uint8_t>(c));
        }
    for (std::uint32_t y = 0; y + 1 < kSide; ++y)
        for (std::uint32_t x = 0; x + 1 < kSide; ++x) {
            const std::uint32_t a = y * kSide + x, b = a + 1, c = a + kSide, d = c + 1;
            w.triangles.push_back({a, b, d});
            w.triangles.push_back({a, d, c});
        }
    return w;
}

// The attributes 0 to 3 are positions, colours, normals and texture coordinates.
std::string dracoOf(const Wave& w, int speed, bool sequential) {
    draco::Mesh mesh;
    mesh.set_num_points(static_cast<std::uint32_t>(w.positions.size()));
    mesh.SetNumFaces(w.triangles.size());
    const auto add = [&](draco::GeometryAttribute::Type type, draco::DataType data, std::int8_t width,
                         std::size_t bytes, const auto& valueOf) {
        draco::GeometryAttribute a;
        a.Init(type, nullptr, width, data, false, static_cast<std::int64_t>(bytes), 0);
        const int id = mesh.AddAttribute(a, true, mesh.num_points());
        for (std::uint32_t i = 0; i < mesh.num_points(); ++i)
            mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), valueOf(i));
    };
    add(draco::GeometryAttribute::POSITION, draco::DT_FLOAT32, 3, 12, [&](std::size_t i) { return &w.positions[i]; });
    add(draco::GeometryAttribute::COLOR, draco::DT_UINT8, 4, 4, [&](std::size_t i) { return &w.colors[4 * i]; });
    add(draco::GeometryAttribute::NORMAL, draco::DT_FLOAT32, 3, 12, [&](std::size_t i) { return &w.normals[i]; });
    add(draco::GeometryAttribute::TEX_COORD, draco::DT_FLOAT32, 2, 8, [&](std::size_t i) { return &w.uvs[i]; });
    for (std::uint32_t f = 0; f < w.triangles.size(); ++f) {
        const auto& t = w.triangles[f];
        mesh.SetFace(draco::FaceIndex(f), {draco::PointIndex(t[0]), draco::PointIndex(t[1]), draco::PointIndex(t[2])});
    }
    if (speed == 0) { // stands before the counts
        auto metadata = std::make_unique<draco::GeometryMetadata>();
        metadata->AddEntryString("name", "wave");
        mesh.AddMetadata(std::move(metadata));
    }
    draco::Encoder encoder;
    encoder.SetSpeedOptions(speed, speed);
    encoder.SetEncodingMethod(sequential ? draco::MESH_SEQUENTIAL_ENCODING : draco::MESH_EDGEBREAKER_ENCODING);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::NORMAL, 10);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::TEX_COORD, 12);
    draco::EncoderBuffer buffer;
    REQUIRE(encoder.EncodeMeshToBuffer(mesh, &buffer).ok());
    return {buffer.data(), buffer.size()};
}

std::string dracoFile(const Wave& w, const std::string& stream) {
    GltfMaker m;
    const int view = m.view(stream);
    const int positions =
        m.raw(fmt::format(R"({{"componentType":5126,"count":{},"type":"VEC3"}})", w.positions.size()));
    const int colors = m.raw(
        fmt::format(R"({{"componentType":5121,"normalized":true,"count":{},"type":"VEC4"}})", w.positions.size()));
    const int indices =
        m.raw(fmt::format(R"({{"componentType":5123,"count":{},"type":"SCALAR"}})", 3 * w.triangles.size()));
    const int normals = m.raw(fmt::format(R"({{"componentType":5126,"count":{},"type":"VEC3"}})", w.positions.size()));
    const int uvs = m.raw(fmt::format(R"({{"componentType":5126,"count":{},"type":"VEC2"}})", w.positions.size()));
    const std::string mesh = fmt::format(
        R"([{{"primitives":[{{"attributes":{{"POSITION":{},"COLOR_0":{},"NORMAL":{},"TEXCOORD_0":{}}},"indices":{},)"
        R"("extensions":{{"KHR_draco_mesh_compression":{{"bufferView":{},"attributes":{{"POSITION":0,"COLOR_0":1,)"
        R"("NORMAL":2,"TEXCOORD_0":3}}}}}}}}]}}])",
        positions, colors, normals, uvs, indices, view);
    return m.binary(R"([{"mesh":0}])", mesh, R"("extensionsRequired":["KHR_draco_mesh_compression"])");
}

// The corners of all triangles, in an order of their own: an encoder may renumber vertices and turn triangles.
std::vector<std::array<int, 3>> cornerSet(const std::vector<Vec3>& positions,
                                          const std::vector<std::array<std::uint32_t, 3>>& triangles) {
    std::vector<std::array<int, 3>> all;
    for (const auto& t : triangles) {
        std::array<int, 3> cells{}; // of a grid of kSide²
        for (std::size_t k = 0; k < 3; ++k)
            cells[k] = static_cast<int>(std::lround(positions[t[k]].x * (kSide - 1))) +
                       kSide * static_cast<int>(std::lround(positions[t[k]].y * (kSide - 1)));
        std::rotate(cells.begin(), std::ranges::min_element(cells), cells.end());
        all.push_back(cells);
    }
    std::ranges::sort(all);
    return all;
}

// The stream of a buffer view and what its extension says about it.
struct Packed {
    std::string bytes, says;
};

std::string meshoptFile(const Packed& vertices, const Packed& indices, std::size_t count, std::size_t corners,
                        const std::string& vertexAccessor, const char* name = "EXT_meshopt_compression") {
    const std::string data = vertices.bytes + indices.bytes;
    const auto view = [&](const Packed& p, std::size_t at, std::size_t unpacked, const char* more) {
        return fmt::format(R"({{"buffer":1,"byteLength":{}{},"extensions":{{"{}":{{"buffer":0,"byteOffset":{},)"
                           R"("byteLength":{},{}}}}}}})",
                           unpacked, more, name, at, p.bytes.size(), p.says);
    };
    const std::string json = fmt::format(
        R"({{"asset":{{"version":"2.0"}},"extensionsRequired":["{}"],"nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[)"
        R"({{"attributes":{{"POSITION":0}},"indices":1}}]}}],"accessors":[{},{{"bufferView":1,"componentType":5125,)"
        R"("count":{},"type":"SCALAR"}}],"bufferViews":[{},{}],"buffers":[{{"byteLength":{}}},{{"byteLength":{},)"
        R"("extensions":{{"{}":{{"fallback":true}}}}}}]}})",
        name, vertexAccessor, corners, view(vertices, 0, count * 12, R"(,"byteStride":12)"),
        view(indices, vertices.bytes.size(), corners * 4, ""), data.size(), 100 * data.size(), name);
    return glb(json, data);
}

Packed packedVertices(const Wave& w, const std::string& filter = "NONE") {
    std::vector<Vec3> values = w.positions;
    if (filter == "EXPONENTIAL")
        meshopt_encodeFilterExp(values.data(), values.size(), sizeof(Vec3), 15, &w.positions[0].x);
    std::vector<unsigned char> to(meshopt_encodeVertexBufferBound(values.size(), sizeof(Vec3)));
    to.resize(meshopt_encodeVertexBuffer(to.data(), to.size(), values.data(), values.size(), sizeof(Vec3)));
    return {{to.begin(), to.end()},
            fmt::format(R"("byteStride":12,"count":{},"mode":"ATTRIBUTES","filter":"{}")", values.size(), filter)};
}

Packed packedIndices(const Wave& w, const std::string& mode = "TRIANGLES") {
    const std::size_t n = 3 * w.triangles.size();
    const std::uint32_t* const from = w.triangles[0].data();
    std::vector<unsigned char> to;
    if (mode == "TRIANGLES") {
        to.resize(meshopt_encodeIndexBufferBound(n, w.positions.size()));
        to.resize(meshopt_encodeIndexBuffer(to.data(), to.size(), from, n));
    } else {
        to.resize(meshopt_encodeIndexSequenceBound(n, w.positions.size()));
        to.resize(meshopt_encodeIndexSequence(to.data(), to.size(), from, n));
    }
    return {{to.begin(), to.end()}, fmt::format(R"("byteStride":4,"count":{},"mode":"{}")", n, mode)};
}

std::string floatAccessor(std::size_t count) {
    return fmt::format(R"({{"bufferView":0,"componentType":5126,"count":{},"type":"VEC3"}})", count);
}

// Every reading ends in a sound mesh or an error.
void survives(const std::string& file) {
    errorOf([&] {
        const MeshFile read = parseGltf(file, "a.glb");
        for (const auto& t : read.mesh.triangles)
            for (const std::uint32_t v : t) REQUIRE(v < read.mesh.positions.size());
        for (const Vec3 p : read.mesh.positions) REQUIRE(isFinite(p));
    });
}

std::string withDamage(std::string bytes, Random& random) {
    const auto below = [&](std::size_t n) {
        return std::min(n - 1, static_cast<std::size_t>(random.uniform() * static_cast<float>(n)));
    };
    for (std::size_t k = 0, changes = 1 + below(4); k < changes; ++k)
        bytes[below(bytes.size())] = static_cast<char>(below(256));
    if (below(10) == 0) bytes.resize(1 + below(bytes.size()));
    return bytes;
}

int triesOf(int usual) { return test::nightly() ? 20 * usual : usual; }

} // namespace

TEST_CASE("gltf: Draco brings back positions, colours and triangles, of all its methods") {
    const Wave w = wave();
    for (const bool sequential : {false, true})
        for (const int speed : {0, 5, 10}) {
            const MeshFile file = parseGltf(dracoFile(w, dracoOf(w, speed, sequential)), "a.glb");
            INFO("speed " << speed << (sequential ? ", sequential" : ", edgebreaker"));
            REQUIRE(file.mesh.positions.size() == w.positions.size());
            CHECK(cornerSet(file.mesh.positions, file.mesh.triangles) == cornerSet(w.positions, w.triangles));
            REQUIRE(file.mesh.attributes.size() == 2);
            float worst = 0, worstColor = 0, worstUv = 0, worstNormal = 0;
            for (std::size_t i = 0; i < w.positions.size(); ++i) {
                const Vec3 p = file.mesh.positions[i];
                worst = std::max(worst, std::abs(p.z - 0.1f * std::sin(9 * p.x + 5 * p.y)));
                worstUv =
                    std::max(worstUv, std::abs(file.mesh.uvs[i].x - p.x) + std::abs(1 - file.mesh.uvs[i].y - p.y));
                const float slope = std::cos(9 * p.x + 5 * p.y);
                const Vec3 n = normalize(Vec3(-0.9f * slope, -0.5f * slope, 1));
                worstNormal = std::max(worstNormal, length(file.mesh.normals[i] - n));
                worstColor = std::max(worstColor, std::abs(file.mesh.attributes[0].values[3 * i] * 255 - p.x * 224));
            }
            CHECK(worst < 2e-4f); // 14 bits of 1 m, and the slope
            CHECK(worstColor < 0.1f);
            CHECK(worstUv < 1e-3f);     // 12 bits
            CHECK(worstNormal < 1e-2f); // 10 bits of an octahedron
        }
}

TEST_CASE("gltf: Draco streams that do not fit their accessors, or are none") {
    const Wave w = wave();
    const std::string stream = dracoOf(w, 5, false);
    const auto fault = [&](const std::string& bytes) {
        return errorOf([&] { parseGltf(dracoFile(w, bytes), "a.glb"); });
    };
    CHECK(fault(stream) == "");
    CHECK(fault("no stream at all")
              .find("meshes[0].primitives[0].extensions.KHR_draco_mesh_compression: bufferViews[0]") !=
          std::string::npos);
    CHECK(fault(stream.substr(0, stream.size() / 2)).find("damaged") != std::string::npos);
    Wave more = w;
    more.positions.emplace_back();
    CHECK(errorOf([&] { parseGltf(dracoFile(more, stream), "a.glb"); }).find("has 81 vertices, its accessor 82") !=
          std::string::npos);
    std::string huge = dracoOf(w, 5, true); // its counts of faces and points, one byte and two before
    huge.replace(11, 2, "\xff\xff\xff\xff\x0f");
    CHECK(fault(huge).find("elements, more than 1024 for each") != std::string::npos);
}

TEST_CASE("gltf: damaged Draco streams are errors or meshes, and cost what they are worth") {
    const Wave w = wave();
    Random random(3);
    for (int i = 0; i < triesOf(1500); ++i)
        survives(dracoFile(w, withDamage(dracoOf(w, i % 3 == 0 ? 0 : i % 3 == 1 ? 5 : 10, i % 2 == 0), random)));
}

TEST_CASE("gltf: meshopt brings back what its encoder took, with the filter for floats") {
    const Wave w = wave();
    for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
        for (const char* mode : {"TRIANGLES", "INDICES"}) {
            const MeshFile file =
                parseGltf(meshoptFile(packedVertices(w), packedIndices(w, mode), w.positions.size(),
                                      3 * w.triangles.size(), floatAccessor(w.positions.size()), name),
                          "a.glb");
            CHECK(file.mesh.positions == w.positions);
            CHECK(cornerSet(file.mesh.positions, file.mesh.triangles) == cornerSet(w.positions, w.triangles));
        }
    const MeshFile file = parseGltf(meshoptFile(packedVertices(w, "EXPONENTIAL"), packedIndices(w), w.positions.size(),
                                                3 * w.triangles.size(), floatAccessor(w.positions.size())),
                                    "a.glb");
    for (std::size_t i = 0; i < w.positions.size(); ++i) CHECK(length(file.mesh.positions[i] - w.positions[i]) < 1e-4f);
}

TEST_CASE("gltf: damaged meshopt streams, and views that state what cannot be") {
    const Wave w = wave();
    const Packed vertices = packedVertices(w), indices = packedIndices(w);
    const std::size_t n = w.positions.size(), corners = 3 * w.triangles.size();
    const auto fault = [&](const Packed& v, const Packed& i) {
        return errorOf([&] { parseGltf(meshoptFile(v, i, n, corners, floatAccessor(n)), "a.glb"); });
    };
    const auto saying = [&](const std::string& says) { return fault({vertices.bytes, says}, indices); };
    CHECK(fault(vertices, indices) == "");
    CHECK(saying(R"("byteStride":12,"count":81,"mode":"POINTS")").find("mode `POINTS`") != std::string::npos);
    CHECK(saying(R"("byteStride":10,"count":81,"mode":"ATTRIBUTES")").find("81 elements of 10 bytes") !=
          std::string::npos);
    CHECK(saying(R"("byteStride":12,"count":81,"mode":"ATTRIBUTES","filter":"OCTAHEDRAL")").find("OCTAHEDRAL") !=
          std::string::npos);
    CHECK(saying(R"("byteStride":12,"count":2000000000,"mode":"ATTRIBUTES")").find("bytes out of") !=
          std::string::npos);
    CHECK(saying(R"("byteStride":12,"count":80,"mode":"ATTRIBUTES")").find("bufferViews[0]") != std::string::npos);
    CHECK(fault({vertices.bytes.substr(1), vertices.says}, indices).find("bufferViews[0].extensions.EXT_meshopt") !=
          std::string::npos);
    Random random(4);
    for (int i = 0; i < triesOf(1500); ++i)
        survives(meshoptFile({withDamage(vertices.bytes, random), vertices.says},
                             {withDamage(indices.bytes, random), indices.says}, n, corners, floatAccessor(n)));
}
