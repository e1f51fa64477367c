// Where exactly a ray meets a segment of a curve, given where about.
#pragma once

#include "geometry/curves_segment.h"

namespace abbe {

struct CurvePoint {
    Vec3d p;       // on the surface
    Vec3d normal;  // unit: out of a tube, to the ray from a ribbon
    Vec3d tangent; // unit
    double u;
    double across; // −1 … 1, as the ray sees it
};

// `u` and `t` as Embree found them, with float precision and, far from the ray's origin, less. `d` is of unit length.
// All results are finite, for degenerate segments too.
CurvePoint tubePoint(const CurveSegment&, double u, Vec3d o, Vec3d d, double t);
// Of two spheres and the cone that touches both.
CurvePoint conePoint(const SizedPoint& a, const SizedPoint& b, Vec3d o, Vec3d d, double t);
// Distances at which a ray enters and leaves that body, which may lie behind it.
std::optional<Vec2d> meetCone(const SizedPoint& a, const SizedPoint& b, Vec3d o, Vec3d d);
CurvePoint ribbonPoint(const CurveSegment&, double u, Vec3d o, Vec3d d);

} // namespace abbe
