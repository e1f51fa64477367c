// What every reader of meshes promises.
#pragma once

#include "fuzz/target.h"
#include "fuzz/targets/reading.h"
#include "io/mesh_file.h"
#include "io/ply_points.h"

#include <algorithm>

namespace abbe::fuzz {

inline void checkMesh(const MeshFile& file) {
    const MeshData& m = file.mesh;
    const std::size_t n = m.positions.size();
    const auto inside = [n](std::uint32_t i) { return i < n; };
    for (const auto& t : m.triangles)
        require(std::ranges::all_of(t, inside), "a triangle of vertices that are not there");
    for (const auto& q : m.quads) require(std::ranges::all_of(q, inside), "a quad of vertices that are not there");
    for (const Vec3& p : m.positions) require(isFinite(p), "a position is not finite");
    require(m.normals.empty() || m.normals.size() == n, "normals of other vertices");
    require(m.uvs.empty() || m.uvs.size() == n, "texture coordinates of other vertices");
    std::size_t triangles = 0, quads = 0;
    for (const MeshGroup& g : file.groups) {
        require(g.firstTriangle == triangles && g.firstQuad == quads, "groups with gaps");
        triangles += g.triangleCount;
        quads += g.quadCount;
    }
    require(file.groups.empty() || (triangles == m.triangles.size() && quads == m.quads.size()),
            "faces without a group");
}

inline void checkCage(const CageFile& file) {
    const SubdivisionCage& c = file.cage;
    std::size_t corners = 0;
    for (const std::uint32_t size : c.faceSizes) corners += size;
    require(corners == c.corners.size(), "faces of other corners");
    for (const std::uint32_t v : c.corners) require(v < c.positions.size(), "a corner of a vertex that is not there");
    for (const std::uint32_t v : c.uvCorners)
        require(v < c.uvs.size(), "a corner of a texture vertex that is not there");
}

} // namespace abbe::fuzz
