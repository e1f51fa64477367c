// Where a light is and where it shines, for choosing among many lights.
#pragma once

#include "math/bounds.h"

namespace abbe {

// Holds whatever the light, or one part of it, gives off while the shutter is open: light leaves points of the box, in
// directions within acos(cosEmission) of a normal that is within acos(cosNormals) of the axis. Wider is never wrong,
// only slower to converge; what is narrower than the light loses light.
struct LightBounds {
    Bounds3 box;           // render space
    Vec3 axis{0, 0, 1};    // unit, of the cone of normals
    float cosNormals = -1; // of its half angle; -1: all directions
    float cosEmission = 0; // of the angle to a normal up to which light leaves; -1: everywhere
    bool twoSided = false; // the same along -axis
    float power = 0;       // as Light::visiblePower(); 0: dark
};

} // namespace abbe
