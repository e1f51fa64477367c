// Points and strands from PLY files: hair, particles, scans.
#pragma once

#include "io/io_error.h"
#include "math/vec.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

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
