// Whether a surface made of faces is closed, as it must be to have an inside.
#pragma once

#include "math/mesh_data.h"
#include "math/vec.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace abbe {

struct OpenEdges {
    std::uint64_t open = 0; // edges of a single face
    std::uint64_t turned =
        0; // edges of several faces that do not lie on its two sides in turn: one faces the other way
    std::optional<std::array<Vec3, 2>> first; // the ends of one of them

    bool closed() const { return open + turned == 0; }
};

// Vertices in the same place count as one, whatever their normals and texture coordinates. Faces without an area, which
// collapse to an edge or a point, have no part in it. In n log n; 12 bytes for each side of each face and 8 for each
// vertex.
class EdgeCounter {
  public:
    // `sides`: how many of all faces will come, if known. The vertices outlive this.
    explicit EdgeCounter(std::span<const Vec3> positions, std::size_t sides = 0);

    void add(std::span<const std::uint32_t> corners);
    // `ends`, if given, gets those of all edges that are open or turned.
    OpenEdges count(std::vector<std::array<Vec3, 2>>* ends = nullptr);

  private:
    struct Edge {
        std::uint32_t a, b;
        int side;
    };
    std::span<const Vec3> positions_;
    std::vector<std::uint32_t> weld_; // one number for all vertices in one place
    std::vector<Edge> edges_;
};

OpenEdges openEdges(const MeshData&);
// Holes are left out.
OpenEdges openEdges(const SubdivisionCage&);

} // namespace abbe
