// Boxes, as meshes of six quads.
#pragma once

#include "math/mesh_data.h"

namespace abbe {

// Closed, faces outwards, in the order -x, +x, -y, +y, -z, +z. Requires lower < upper on every axis.
MeshData boxMesh(Vec3d lower, Vec3d upper);

} // namespace abbe
