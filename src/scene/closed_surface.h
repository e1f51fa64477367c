// Whether a surface made of faces is closed, as it must be to hold a medium.
#pragma once

#include "math/mesh_data.h"

#include <cstdint>

namespace abbe {

struct OpenEdges {
    std::uint64_t open = 0; // edges of a single face
    std::uint64_t turned =
        0; // edges of several faces that do not lie on its two sides in turn: one faces the other way

    bool closed() const { return open + turned == 0; }
};

// Vertices in the same place count as one, whatever their normals and texture coordinates. Faces without an area, which
// collapse to an edge or a point, have no part in it.
OpenEdges openEdges(const MeshData&);
// Holes are left out.
OpenEdges openEdges(const SubdivisionCage&);

} // namespace abbe
