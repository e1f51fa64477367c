// Voxels as OpenVDB files, for grids that a foreign scene states in its own text or in a format that scenes do not
// read.
#pragma once

#include <array>
#include <span>
#include <string>

namespace abbe::exchange {

// A file with the one grid `density` of floats: the value of voxel x, y, z, which is values[(z * ny + y) * nx + x], has
// its centre at the point x, y, z of the file. Zero elsewhere; blocks of zeros are left out. Requires as many values
// as the product of the counts.
std::string vdbFile(std::array<int, 3> counts, std::span<const float> values);

} // namespace abbe::exchange
