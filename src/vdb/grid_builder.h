// Grids made leaf by leaf in parallel, and files of them.
#pragma once

#include "vdb/instantiated.h"
#include "volumes/volume_recipe.h"

#include <functional>
#include <openvdb/Grid.h>
#include <openvdb/openvdb.h>
#include <string>

namespace abbe::vdb {

// Sets the values of the leaf whose first voxel is given; false if all are 0.
using LeafFunction = std::function<bool(Vec3T<int> origin, RecipeLeaf& leaf)>;

// One grid per field, float or Vec3s, of all leaves in the box (voxels). Progress goes to the program, up to `done`.
openvdb::GridPtrVec buildGrids(std::span<const RecipeField> fields, const openvdb::CoordBBox& voxels,
                               const LeafFunction& leaf, double done);

// Writes all grids, compressed by blosc, and reads the last one back. Throws Failure.
void writeGrids(const std::string& path, const openvdb::GridPtrVec& grids);

} // namespace abbe::vdb
