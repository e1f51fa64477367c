// The direction that an OpenPBR highlight is stretched along.
#pragma once

#include "render/surface_hit.h"
#include "schema/type.h"

namespace abbe {

// `tangent`: turns from the texture's u, or a texture of directions along u and v, 0 … 1 for -1 … 1. In render space,
// of any length; across the unit normal n only about. Requires the parametrisation of the hit, without which shading.x
// stands for u.
Vec3 openPbrTangent(const schema::TexturedNumber& tangent, const SurfaceHit& hit, Vec3 n);

} // namespace abbe
