// A triangle seen from a point: its solid angle, and uniform directions into it [Arvo1995].
#pragma once

#include "math/vec.h"

namespace abbe {

class SphericalTriangle {
  public:
    // Corners relative to the point, none of which is 0.
    SphericalTriangle(Vec3d a, Vec3d b, Vec3d c);

    double solidAngle() const { return solidAngle_; } // sr, of either side
    // A unit vector. The corners of the square are b (twice), a and c: (0, 0), (1, 0), (0, 1) and (1, 1).
    // Requires solidAngle() > 0.
    Vec3d direction(Vec2 u) const;
    // The u of a direction into the triangle.
    Vec2 inverse(Vec3d direction) const;

  private:
    Vec3d a_, b_, c_; // unit
    double solidAngle_;
};

} // namespace abbe
