// Textures of directions.
#pragma once

#include "render/texture_query.h"

namespace abbe {

// A texture of slopes: what bends the shading normal.
struct NormalMap {
    const Texture* texture = nullptr; // three channels, 0 … 1 for -1 … 1
    float strength = 1;               // factor of x and y
};

// The unit normal that the map says, in ng's hemisphere or not: `hit` unbent. Where there are no texture coordinates
// (dpdu = 0) it says nothing.
Vec3 mappedNormal(const NormalMap&, const SurfaceHit& hit);

} // namespace abbe
