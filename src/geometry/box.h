// Boxes, as meshes of six quads.
#pragma once

#include "geometry/shape_params.h"
#include "math/mesh_data.h"

namespace abbe {

// Closed, faces outwards, in the order -x, +x, -y, +y, -z, +z. Requires lower < upper on every axis.
MeshData boxMesh(Vec3d lower, Vec3d upper);

struct BoxParams : ShapeParams {
    Vec3d center;
    std::optional<Vec3d> size; // unset, and no corners: 1 1 1
    std::optional<Vec3d> min, max;
};

schema::TypeInfo boxType();
// Nothing after an error.
std::optional<UnplacedShape> makeBox(const BoxParams&, const ShapeContext&);

} // namespace abbe
