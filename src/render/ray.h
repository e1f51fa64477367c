#pragma once

#include "math/vec.h"
#include "render/visibility.h"

namespace abbe {

// Render space. `direction` is of unit length; `time` in [0, 1] of the shutter interval.
struct Ray {
    Vec3 origin;
    Vec3 direction;
    float tMax = kInfinity;
    float time = 0;
    RayKind kind = RayKind::scattered; // shapes that it does not see are not there
};

// A part of a ray.
struct RayExtent {
    float tNear = 0, tFar = 0;
    bool empty() const { return !(tNear < tFar); }
};

} // namespace abbe
