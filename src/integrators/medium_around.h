// What a camera is immersed in.
#pragma once

#include "integrators/medium_stack.h"
#include "render/scene.h"

namespace abbe {

// The interiors of shapes that contain a point at a time (in the shutter interval): those that a ray from it leaves
// without having entered them.
MediumStack mediaAround(const Scene&, Vec3 point, float time);

// Steps over the boundary at `hit` in the direction `w`.
inline bool crossBoundary(const SurfaceHit& hit, Vec3 w, MediumStack& inside) {
    const Medium* medium = hit.material->interior();
    if (!medium) return true;
    if (dot(w, hit.ng) < 0) return inside.enter(medium);
    inside.leave(medium);
    return true;
}

} // namespace abbe
