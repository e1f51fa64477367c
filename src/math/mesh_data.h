// A polygon mesh as files and scenes state it; geometry/ renders it, io/ reads it.
#pragma once

#include "math/vec.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace abbe {

// Numbers or colours at vertices, by name; between vertices they are interpolated.
struct MeshAttribute {
    std::string name;
    int channels = 1;          // 1 or 3
    std::vector<float> values; // `channels` for each vertex, finite
};

// Vertices shared by triangles and quads; counter-clockwise seen from outside. `normals` and `uvs` are per vertex:
// each is empty or as long as `positions`.
struct MeshData {
    std::vector<Vec3> positions;
    std::vector<Vec3> normals;
    std::vector<Vec2> uvs;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<std::array<std::uint32_t, 4>> quads;
    std::vector<MeshAttribute> attributes = {};
};

// Which group of a file each face of a mesh belongs to, by its number in `names`.
struct FaceGroups {
    std::vector<std::string> names; // may repeat, and be empty
    std::vector<std::uint32_t> triangles, quads;
};

} // namespace abbe
