// Where light is asked for.
#pragma once

#include "math/vec.h"

namespace abbe {

// A point of a surface or of a medium. With a normal, light from behind it counts for nothing, unless the surface
// lets light through: choosing and sampling lights may use that, and must not lose any light that counts.
struct Receiver {
    Receiver(Vec3 point) : p(point) {} // NOLINT: a point is a receiver of light from everywhere
    Receiver(Vec3 point, Vec3 normal, bool bothSides) : p(point), n(normal), surface(true), twoSided(bothSides) {}

    Vec3 p;
    Vec3 n;                // unit; that of the shading frame, on the side of the eye
    bool surface = false;  // whether n means anything
    bool twoSided = false; // light from behind n counts too

    // Light from behind n counts for nothing.
    bool oneSided() const { return surface && !twoSided; }
};

} // namespace abbe
