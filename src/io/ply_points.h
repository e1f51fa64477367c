// Vertices of PLY files with whatever properties they have; points and strands: hair, particles, scans.
#pragma once

#include "io/file.h"
#include "math/vec.h"

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

// Properties that a reader knows, in its own order; `present` tells which of them the file has. x, y and z always are.
struct PlyColumns {
    std::vector<std::string_view> names;
    std::vector<bool> present;
    std::uint64_t count = 0; // vertices

    bool has(std::string_view name) const;
};

// Told once before the first vertex; may throw IoError to refuse what is there.
using PlyColumnsVisitor = std::function<void(const PlyColumns&)>;
// The values of one vertex in the order of the names, finite; 0 where the file has none. False ends the reading.
using PlyVertexVisitor = std::function<bool(std::uint64_t index, std::span<const double>)>;

// Throws IoError with the byte offset of the first fault; `name` is for messages.
void visitPlyVertices(std::string_view bytes, const std::string& name, std::vector<std::string_view> properties,
                      const PlyColumnsVisitor&, const PlyVertexVisitor&);

struct PointFile {
    std::vector<Vec3> positions; // finite
    std::vector<float> radii;    // >= 0, one per point; empty if the file has none
    std::vector<Vec3> normals;   // finite, of any length, one per point; empty if the file has none
    std::vector<std::uint32_t> strandSizes;
    // The points of the strands one after the other; empty if they are all points in order.
    std::vector<std::uint32_t> strandPoints;
};

// Vertices with x y z, `radius` (or `width`, twice as much) and nx ny nz; an element `curve` or `strand` with a list
// `vertex_indices` (`vertex_index`) or a number `count`. Everything else is passed over. Throws IoError with the byte
// offset of the first fault; `name` is for messages.
PointFile parsePlyPoints(std::string_view bytes, const std::string& name);
PointFile readPlyPoints(const std::string& path);

} // namespace abbe
