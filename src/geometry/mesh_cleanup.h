// Checks a mesh and removes what cannot be rendered.
#pragma once

#include "math/mesh_data.h"

#include <cstdint>
#include <optional>
#include <string>

namespace abbe {

struct MeshCleanup {
    std::uint64_t zeroArea = 0;         // faces removed: slivers of no measurable area
    std::uint64_t repeatedIndices = 0;  // faces removed: fewer than three different corners
    std::uint64_t quadsToTriangles = 0; // quads with one repeated corner
    // What makes the mesh unusable, naming the face or the vertex (from 0); the mesh is then unchanged.
    std::optional<std::string> error;

    std::uint64_t removed() const { return zeroArea + repeatedIndices; }
};

// Errors: indices beyond the vertices, positions, normals or uvs that are not finite, normals or uvs that are not one
// per vertex, more faces than 32 bits count. A face has no area if twice its area is below 1e-6 of the square of its
// longest edge and its area below 1e-12 of the square of the mesh's diagonal: small but well-shaped faces stay.
// Groups stay with their faces. Requires groups, where given, of as many faces as the mesh has.
MeshCleanup cleanMesh(MeshData&, FaceGroups* = nullptr);

} // namespace abbe
