// Cylinders, cones and truncated cones.
#pragma once

#include "geometry/parametric_shape.h"
#include "geometry/shape_params.h"

namespace abbe {

// In its own space: the surface between two circles about the y axis, of radius `bottom` at -height / 2 and of radius
// `top` at +height / 2, closed by two disks unless it is open. On the side u is the longitude / 2π from +z towards +x
// and v rises from 0 to 1; on the disks u is the distance from the axis / radius, v the longitude / 2π.
// Requires radii >= 0, not both 0, and height > 0.
class Frustum final : public ParametricShape {
  public:
    Frustum(double bottom, double top, double height, bool closed, const Transform& toRender);

  private:
    enum Part : int { side, bottomCap, topCap };

    std::optional<LocalHit> intersectLocal(Vec3d o, Vec3d d, double tMax) const override;
    LocalPoint project(Vec3d p, int part) const override;
    LocalDerivatives derivatives(const LocalPoint&, int part) const override;
    LocalPoint sampleLocal(Vec2d u) const override;

    double radiusAt(double y) const;
    LocalPoint sidePoint(double longitude, double y) const;
    LocalPoint capPoint(Part, double x, double z) const;
    double areaUnderMap() const;

    double bottom_, top_, halfHeight_;
    double slope_; // of the radius over y
    bool closed_;
    double reach2_;                 // square of the radius of the bounding sphere about the origin
    Vec2d sideNormal_;              // outwards and along y, unit
    double sideArea_, capAreas_[2]; // own space; caps 0 when open
};

// Both about their centre.
struct CylinderParams : ShapeParams {
    Vec3d center;
    std::optional<Vec3d> axis; // unset: up
    double radius = 0.5, height = 1;
    bool caps = true;
};
struct ConeParams : ShapeParams {
    Vec3d center;
    std::optional<Vec3d> axis; // unset: up
    double radius = 0.5, topRadius = 0, height = 1;
    bool caps = true;
};

schema::TypeInfo cylinderType();
schema::TypeInfo coneType();
// Nothing after an error.
std::optional<UnplacedShape> makeCylinder(const CylinderParams&, const ShapeContext&);
std::optional<UnplacedShape> makeCone(const ConeParams&, const ShapeContext&);

} // namespace abbe
