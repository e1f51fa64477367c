// What a camera is immersed in.
#pragma once

#include "integrators/surroundings.h"
#include "render/scene.h"

namespace abbe {

// What the shapes that contain a point at a time (in the shutter interval) are made of and filled with: those that a
// ray from it leaves without having entered them.
Surroundings surroundingsAt(const Scene&, Vec3 point, float time);

} // namespace abbe
