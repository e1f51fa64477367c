// Small glTF files made in memory.
#pragma once

#include "io/gltf.h"

#include <concepts>
#include <cstdint>
#include <cstring>
#include <fmt/format.h>
#include <initializer_list>
#include <string>

namespace abbe::test {

template <typename T> std::string bytesOf(std::initializer_list<T> values) {
    std::string out;
    for (const T v : values) out.append(reinterpret_cast<const char*>(&v), sizeof v);
    return out;
}

inline std::string word32(std::size_t v) { return bytesOf<std::uint32_t>({static_cast<std::uint32_t>(v)}); }

inline std::string glb(std::string json, std::string bin) {
    json.resize((json.size() + 3) / 4 * 4, ' ');
    bin.resize((bin.size() + 3) / 4 * 4, '\0');
    const std::string chunks = word32(json.size()) + "JSON" + json + word32(bin.size()) + std::string("BIN\0", 4) + bin;
    return "glTF" + word32(2) + word32(12 + chunks.size()) + chunks;
}

// A unit square in the xy-plane: 4 positions, normals, uvs (from byte 48 and 96), 6 indices of 16 bits (from 128).
inline std::string squareData() {
    return bytesOf<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) + bytesOf<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}) +
           bytesOf<float>({0, 1, 1, 1, 1, 0, 0, 0}) + bytesOf<std::uint16_t>({0, 1, 2, 0, 2, 3});
}

// The parts of a file's JSON, to be replaced one by one.
struct GltfText {
    std::string scene = R"("scene":0,"scenes":[{"nodes":[0]}],)";
    std::string nodes = R"([{"name":"Square","mesh":0}])";
    std::string primitive = R"({"attributes":{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2},"indices":3})";
    std::string accessors = R"([{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
                            R"({"bufferView":1,"componentType":5126,"count":4,"type":"VEC3"},)"
                            R"({"bufferView":2,"componentType":5126,"count":4,"type":"VEC2"},)"
                            R"({"bufferView":3,"componentType":5123,"count":6,"type":"SCALAR"}])";
    std::string views =
        R"([{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":48},)"
        R"({"buffer":0,"byteOffset":96,"byteLength":32},{"buffer":0,"byteOffset":128,"byteLength":12}])";
    std::string more; // further members, each with a comma in front
    std::string data = squareData();
    std::string uri;

    std::string json() const {
        const std::string where = uri.empty() ? "" : fmt::format(R"("uri":"{}",)", uri);
        return fmt::format(
            R"({{"asset":{{"version":"2.0"}},{}"nodes":{},"meshes":[{{"name":"Plate","primitives":[{}]}}],)"
            R"("accessors":{},"bufferViews":{},"buffers":[{{{}"byteLength":{}}}]{}}})",
            scene, nodes, primitive, accessors, views, where, data.size(), more);
    }
    std::string binary() const { return glb(json(), data); }
    MeshFile mesh(const GltfSelection& selection = {}) const { return parseGltf(binary(), "test.glb", selection); }
};

// The message of the error, or nothing.
template <std::invocable F> std::string errorOf(F&& f) {
    try {
        f();
    } catch (const IoError& e) {
        return e.what();
    }
    return {};
}

inline std::string errorOf(const GltfText& text, const GltfSelection& selection = {}) {
    return errorOf([&] { text.mesh(selection); });
}

} // namespace abbe::test
