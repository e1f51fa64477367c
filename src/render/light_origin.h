// A point of a light from which a path of light starts.
#pragma once

#include "math/vec.h"
#include "spectrum/spectrum.h"

#include <cmath>
#include <cstdint>

namespace abbe {

// Drawn with no regard to any receiver. Render space.
struct LightOrigin {
    // Where light leaves to: everywhere, from a point without a surface; or from the outer side, or both, of a surface.
    enum class Sides : std::uint8_t { all, front, both };

    // On a light that is a point: its density is a delta.
    static LightOrigin at(Vec3 point, float time, float largest) {
        LightOrigin origin;
        origin.p = point;
        origin.time = time;
        origin.pdf = 1;
        origin.largest = largest;
        return origin;
    }

    Vec3 p;
    Vec3 pError;       // bound on the absolute error of p, per axis
    Vec3 n;            // unit, outside; 0 without a surface
    float pdf = 0;     // 1/m², of the point among those of its part; 1 without a surface
    float largest = 0; // 1/sr: the largest density of the light's own directions there
    Sides sides = Sides::all;
    float time = 0;       // Ray::time
    Spectrum factor{1.f}; // what dims the light there: a texture

    bool point() const { return sides == Sides::all; }
    // What turns radiance into exitance: |cos θ| in the unit direction w, 1 without a surface.
    float cosine(Vec3 w) const { return point() ? 1.f : std::abs(dot(n, w)); }
};

} // namespace abbe
