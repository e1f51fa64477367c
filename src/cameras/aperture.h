// The opening of a lens: a circle, or the polygon that straight or rounded blades leave.
#pragma once

#include "math/vec.h"

namespace abbe {

// Sampled uniformly and exactly. Blades change its form and not its area, which is that of a circle of the given
// radius: an f-number means the same light with any iris. The edge lies at r²(φ) = (1-k) p²(φ) + k R², where p is the
// polygon inscribed in a circle of radius R and k the roundness: straight at 0, a circle at 1.
class Aperture {
  public:
    // A point.
    Aperture() = default;
    // A circle with `radius` in m, >= 0.
    explicit Aperture(double radius) : radius_(radius), outer_(radius) {}
    // With `blades` >= 3, one of their corners upright and then turned counter-clockwise (x right, y up) by `rotation`
    // in radians; `roundness` in [0, 1].
    Aperture(double radius, int blades, double rotation, double roundness);

    bool isPoint() const { return radius_ == 0; }
    bool isCircle() const { return blades_ == 0; }
    double radius() const { return radius_; }     // of the circle with the same area, m
    double outerRadius() const { return outer_; } // no point lies beyond, m
    Vec2 sample(Vec2 u) const noexcept;
    bool contains(Vec2d) const noexcept;

  private:
    double edgeSquared(double tangent) const; // r² at the given tangent of the angle from the middle of a blade

    double radius_ = 0;
    double outer_ = 0;
    int blades_ = 0;
    double turn_ = 0;      // direction of the middle of blade 0, rad
    double round_ = 0;     // k
    double inner_ = 0;     // distance of a straight edge, m
    double halfAngle_ = 0; // π / blades
    double tanHalf_ = 0;
    double straight_ = 1; // share of the polygon's part in the area
};

} // namespace abbe
