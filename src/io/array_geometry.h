// Meshes, cages, points and pictures out of arrays in memory (base/named_arrays.h), for the readers of files.
#pragma once

#include "base/named_arrays.h"
#include "io/image.h"
#include "io/mesh_file.h"
#include "io/ply_points.h"

namespace abbe {

// All throw IoError where numbers are not finite, indices out of range, or lengths do not fit.

// "points" (3), "normals" (3), "uvs" (2) and "attribute:NAME" (1 or 3), for each point; "faces", and "face-sizes" or
// else size[0] corners in each.
MeshFile meshOf(const NamedArrays&, const std::string& name);
CageFile cageOf(const NamedArrays&, const std::string& name);
// "points" (3), "radii", "normals" (3); "counts" of strands.
PointFile pointsOf(const NamedArrays&, const std::string& name);
// "pixels", rows from the top: linear RGB of Rec. 709.
RgbImage imageOf(const NamedArrays&, const std::string& name);

} // namespace abbe
