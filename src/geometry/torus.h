// Tori.
#pragma once

#include "geometry/parametric_shape.h"
#include "geometry/shape_params.h"

namespace abbe {

// In its own space: the tube of radius `minor` about a circle of radius `major` around the y axis. u is the longitude
// / 2π from +z towards +x, v the angle around the tube / 2π, from the outer equator upwards.
// Requires major >= minor > 0: equal radii (a horn torus) touch in the centre, larger tubes would cross themselves.
class Torus final : public ParametricShape {
  public:
    Torus(double major, double minor, const Transform& toRender);

  private:
    std::optional<LocalHit> intersectLocal(Vec3d o, Vec3d d, double tMax) const override;
    LocalPoint project(Vec3d p, int part) const override;
    LocalDerivatives derivatives(const LocalPoint&, int part) const override;
    LocalPoint sampleLocal(Vec2d u) const override;

    LocalPoint at(double sinLongitude, double cosLongitude, double across, double up) const;
    double areaUnderMap() const;

    double major_, minor_;
};

// About its centre.
struct TorusParams : ShapeParams {
    Vec3d center;
    std::optional<Vec3d> axis; // unset: up
    double majorRadius = 0.5, minorRadius = 0.125;
};

schema::TypeInfo torusType();
// Nothing after an error.
std::optional<UnplacedShape> makeTorus(const TorusParams&, const ShapeContext&);

} // namespace abbe
