// Directions to a sphere by the cosine at a receiver.
#pragma once

#include "render/receiver.h"

#include <optional>

namespace abbe {

// Uniform over the projection of the cone to the sphere on the receiver's tangent plane: an ellipse, or where the
// horizon cuts the cone, what of it lies within the unit circle's arc [Peters2019].
class ProjectedCap {
  public:
    // Of the cone towards a sphere at distance² d2 > r2 in the unit direction `axis`. Nothing if it is too narrow for
    // the cosine to vary, hardly above the horizon, or if light from behind the receiver counts, too. A sampler and its
    // density both decide by this function.
    static std::optional<ProjectedCap> seen(const Receiver& from, Vec3d axis, double d2, double r2);

    Vec3d direction(Vec2 u) const; // unit, in the cone but for rounding
    double pdf(Vec3d w) const;     // 1/sr, of a direction in the cone

  private:
    ProjectedCap() = default;
    double middle(double y) const;
    double wing(double y) const;
    double inverse(double area) const;
    Vec2d place(Vec2 u) const;

    Vec3d n_, x_, y_;       // of the receiver; the axis of the cone is in the plane of n and x
    double centre_ = 0;     // of the ellipse, along x
    double a_ = 0, b_ = 0;  // its half axes, along x and y; a < 0 where the sphere's centre is below the horizon
    double tangent_ = 0;    // y where the ellipse meets the unit circle; 0 where the horizon does not cut the cone
    double middleArea_ = 0; // of the half y > 0: between the ellipse and the arc, up to the tangent
    double solidAngle_ = 0; // projected, sr
};

} // namespace abbe
