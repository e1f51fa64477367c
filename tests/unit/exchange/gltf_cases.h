// Imports of glTF scenes that stand in tests as text.
#pragma once

#include "exchange/importer/importer.h"
#include "unit/exchange/import_case.h"

#include <algorithm>
#include <cstring>
#include <doctest/doctest.h>
#include <string>
#include <vector>

namespace abbe::exchange {

// The file beside it, case.bin, is that of gltfWall().
struct GltfCase : ImportCase {
    // `picture`: what stands in tex.png, if anything.
    explicit GltfCase(const std::string& text, const std::string& picture = {}) {
        if (!picture.empty()) writeAll(folder / "tex.png", picture);
        import(text);
    }
    // For those that write files first.
    GltfCase() = default;
    void import(const std::string& text);

    // Whether this stands in it, whatever the lines: `{ a; b }`.
    bool has(std::string_view text) const {
        std::string line;
        for (std::size_t i = 0; i < scene.size(); ++i) {
            if (scene[i] != '\n') {
                line += scene[i];
                continue;
            }
            const std::size_t next = std::min(scene.find_first_not_of(" \n", i), scene.size());
            line += line.ends_with('{') || (next < scene.size() && scene[next] == '}') ? " " : "; ";
            i = next - 1;
        }
        return line.find(text) != std::string::npos;
    }
};

// The buffer of a square of 2 × 2 m in the plane z = 0 that faces +z: positions, normals, coordinates of which v = 0 is
// above, colours of 1/2, and the times 0 and 1 s with places that are 0 and 2 m to the right.
inline std::string gltfBuffer() {
    const std::vector<float> numbers = {-1, -1, 0,  1,  -1, 0,  1,  1,  0,  -1, 1,  0,  // 0
                                        0,  0,  1,  0,  0,  1,  0,  0,  1,  0,  0,  1,  // 48
                                        0,  1,  1,  1,  1,  0,  0,  0,                  // 96
                                        .5, .5, .5, .5, .5, .5, .5, .5, .5, .5, .5, .5, // 128
                                        0,  1,  0,  0,  0,  2,  0,  0};                 // 176
    const std::vector<std::uint16_t> corners = {0, 1, 2, 0, 2, 3};                      // 208
    std::string bytes(numbers.size() * 4 + corners.size() * 2, '\0');
    std::memcpy(bytes.data(), numbers.data(), numbers.size() * 4);
    std::memcpy(bytes.data() + numbers.size() * 4, corners.data(), corners.size() * 2);
    return bytes;
}

inline void GltfCase::import(const std::string& text) {
    writeAll(folder / "case.bin", gltfBuffer());
    writeAll(folder / "case.gltf", text);
    const ImportFormat* const format = importFormat(folder / "case.gltf");
    REQUIRE(format);
    REQUIRE(format->name == "gltf");
    scene = importScene(*format, folder / "case.gltf", folder / "case.scene", sources, diagnostics).value_or("");
}

// A file whose mesh 0 is that square with material 0; `more` are members of the outermost object: nodes, materials.
inline std::string gltfWall(const std::string& more, const std::string& attributes = "",
                            const std::string& primitive = "") {
    return R"({"asset":{"version":"2.0"},"scene":0,"buffers":[{"uri":"case.bin","byteLength":220}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":220}],
"accessors":[{"bufferView":0,"byteOffset":0,"componentType":5126,"count":4,"type":"VEC3","min":[-1,-1,0],"max":[1,1,0]},
{"bufferView":0,"byteOffset":48,"componentType":5126,"count":4,"type":"VEC3"},
{"bufferView":0,"byteOffset":96,"componentType":5126,"count":4,"type":"VEC2"},
{"bufferView":0,"byteOffset":208,"componentType":5123,"count":6,"type":"SCALAR"},
{"bufferView":0,"byteOffset":128,"componentType":5126,"count":4,"type":"VEC3"},
{"bufferView":0,"byteOffset":176,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[1]},
{"bufferView":0,"byteOffset":184,"componentType":5126,"count":2,"type":"VEC3"},
{"bufferView":0,"byteOffset":0,"componentType":5126,"count":17,"type":"VEC3"}],
"meshes":[{"name":"wall","primitives":[{"attributes":{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2)" +
           attributes + R"(},"indices":3,"material":0)" + primitive + R"(}]}],
)" + more + "}";
}

// One node with that mesh and a material.
inline std::string gltfMaterial(const std::string& material, const std::string& more = "") {
    return gltfWall(R"("scenes":[{"nodes":[0]}],"nodes":[{"name":"wall","mesh":0}],"materials":[{"name":"paint",)" +
                    material + "}]" + more);
}

} // namespace abbe::exchange
