// Voxels as OpenVDB files, for grids that a foreign scene states in its own text or in a format that scenes do not
// read.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

namespace abbe::exchange {

struct VdbGrid {
    std::string_view name; // "density"
    std::span<const float> values;
};

// A file with grids of floats: the value of voxel x, y, z, which is values[(z * ny + y) * nx + x], has its centre at
// the point x, y, z of the file. Zero elsewhere; blocks of zeros are left out. Requires as many values in each grid as
// the product of the counts.
std::string vdbFile(std::array<int, 3> counts, std::span<const VdbGrid> grids);

} // namespace abbe::exchange
