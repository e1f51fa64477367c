// Infinite planes.
#pragma once

#include "geometry/shape_params.h"
#include "math/transform.h"
#include "render/shape.h"

namespace abbe {

// uv are metres along two axes of the plane from `point`. Emits nothing: its area is infinite.
// Requires normal != 0. Rays may have directions of any length.
class Plane final : public Shape {
  public:
    Plane(Vec3d point, Vec3d normal);
    // Of what this map makes of a plane in its own space: textures see metres along axes there.
    Plane(Vec3d point, Vec3d normal, const Transform& place);

    // Finite because Embree needs it, and so large that no scene sees the edge.
    Bounds3 bounds() const override;
    void commit(GeometrySink&) const override;
    std::optional<RawHit> intersect(const Ray&) const override;
    void surface(const RawHit&, const Ray&, SurfaceHit&) const override;
    void parametrize(const RawHit&, const Ray&, SurfaceHit&) const override;
    std::optional<SurfacePatch> patch(const SurfaceHit&, Vec3d origin, Vec3d direction) const noexcept override;
    Relief relief() const override { return Relief::smooth; }
    double area() const override;

  private:
    Vec3d point_, x_, y_, z_;
    Vec3d byU_, byV_; // dp/du and dp/dv for textures
    Vec3d toU_, toV_; // whose dot products with a vector of the plane are u and v
};

struct PlaneParams : ShapeParams {
    Vec3d center;
    std::optional<Vec3d> normal; // unset: up
};

schema::TypeInfo planeType();
UnplacedShape makePlane(const PlaneParams&, const ShapeContext&);

} // namespace abbe
