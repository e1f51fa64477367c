// How much light comes in and what it counts for: the opening of a lens (a circle, or the polygon that straight or
// rounded blades leave), the shutter's times, and how radiance becomes pixel values.
#pragma once

#include "math/vec.h"

#include <cmath>

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

// Transmission over time: a ramp up, a plateau, a ramp down. `exposure` is the time of a sudden shutter that lets in as
// much light, which is what cameras state; ramps make the whole longer.
struct Shutter {
    double open = 0;     // s, when it begins to open
    double exposure = 0; // s, >= 0
    double opening = 0;  // length of the ramps, in units of the exposure; opening + closing <= 2
    double closing = 0;

    double duration() const { return exposure * (1 + 0.5 * (opening + closing)); } // from first to last light
    // Where u in [0, 1) falls in the interval, in [0, 1], with the density of the transmission: its inverse cumulative
    // distribution.
    double position(double u) const;
    double timeAt(double position) const { return open + position * duration(); } // s
};

// At 0 stops and a sensitivity of 1 a pixel of Y = 1 stands for 72 983 nits (docs/conventions.md).
struct Exposure {
    double sensitivity = 1; // pixel value per unit of radiance at 0 stops
    double stops = 0;       // of the camera's `exposure`; 0 while an automatic one is not known
    bool automatic = false; // `exposure auto`: a look at the scene finds the stops

    double factor() const { return std::exp2(stops) * sensitivity; }
};

} // namespace abbe
