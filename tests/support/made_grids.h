// Grids of stated voxels. The library's builder takes long to compile, so it is compiled once for all tests.
#pragma once

#include "volumes/voxel_grid.h"

#include <span>

namespace abbe {

// One voxel of a grid that is made in memory.
struct Voxel {
    Vec3i place;
    float value = 0;
};
struct VectorVoxel {
    Vec3i place;
    Vec3 value;
};

// A grid of the given voxels, all active, 0 elsewhere.
// Requires: values finite and not negative, facts.indexToWorld invertible.
VoxelGrid makeVoxelGrid(std::span<const Voxel> voxels, GridFacts facts);
// The same of vectors, whose components may be negative.
VectorGrid makeVectorGrid(std::span<const VectorVoxel> voxels, GridFacts facts);

} // namespace abbe
