// One segment of a curve as a polynomial, in double.
#pragma once

#include "render/shape.h"

#include <array>

namespace abbe {

// Position and radius over u in [0, 1]: Σ c[k] u^k.
class CurveSegment {
  public:
    // `points`: the segment's first control point; two are read for linear, else four.
    CurveSegment(CurveBasis, const SizedPoint* points);

    Vec3d position(double u) const { return c_[0] + u * (c_[1] + u * (c_[2] + u * c_[3])); }
    Vec3d derivative(double u) const { return c_[1] + u * (2.0 * c_[2] + (3 * u) * c_[3]); }
    Vec3d secondDerivative(double u) const { return 2.0 * c_[2] + (6 * u) * c_[3]; }
    // Not negative, though a spline through positive radii may be.
    double radius(double u) const { return std::max(0.0, r_[0] + u * (r_[1] + u * (r_[2] + u * r_[3]))); }
    double radiusDerivative(double u) const { return r_[1] + u * (2 * r_[2] + 3 * u * r_[3]); }

    // Unit direction of travel. Where the derivative vanishes (cusps, equal control points) it comes from differences
    // over a growing interval (docs/hard_cases.md, case 22); nothing if the whole segment is one point.
    std::optional<Vec3d> tangent(double u) const;
    // The control points of the same segment as a Bézier curve: it lies in their hull, its radius between theirs.
    void bezier(std::array<Vec3d, 4>& points, std::array<double, 4>& radii) const;

  private:
    std::array<Vec3d, 4> c_;
    std::array<double, 4> r_;
};

} // namespace abbe
