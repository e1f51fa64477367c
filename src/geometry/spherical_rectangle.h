// A rectangle seen from a point: its solid angle, and uniform directions into it [Urena2013].
#pragma once

#include "math/vec.h"

#include <array>

namespace abbe {

// In the rectangle's own coordinates relative to the point: x and y along its sides, z along its normal.
// The paper takes the angles of the spherical polygon by acos, which loses half its digits near 0 and π (points near
// the plane). Here the sine is known without cancellation and the angle comes from atan2.
class SphericalRectangle {
  public:
    // The rectangle [x0, x1] × [y0, y1] at height z; any sign of z. A point in the plane gives solid angle 0.
    SphericalRectangle(float x0, float y0, float x1, float y1, float z);

    float solidAngle() const { return solidAngle_; }
    // (x, y) on the rectangle, uniform per solid angle. Requires solidAngle() > 0.
    Vec2 sample(Vec2 u) const;
    // The u that samples a point of the rectangle, to about 1e-6 sr over the solid angle.
    Vec2 inverse(Vec2 point) const;

  private:
    float x0_, y0_, x1_, y1_, z_;
    float b0_, b1_;    // z components of the normals of the planes through the sides y = y0 and y = y1
    float sine0_;      // sqrt(1 - b0²)
    float k_;          // 2π - γ2 - γ3 of the paper
    float solidAngle_; // sr
};

} // namespace abbe
