// Round shapes under maps that do not keep them round: ellipsoids and ellipses.
#pragma once

#include "geometry/disk.h"
#include "geometry/instance.h"
#include "geometry/sphere.h"

#include <memory>

namespace abbe {

// Requires an invertible map. Sampled as the shape itself is, from the point's preimage; the density is carried over
// exactly by the Jacobian of the map of directions.
class Transformed final : public Shape, public SurfaceSampling {
  public:
    Transformed(std::unique_ptr<const Sphere>, const Transform& toRender);
    Transformed(std::unique_ptr<const Disk>, const Transform& toRender);

    Bounds3 bounds() const override { return bounds_; }
    void commit(GeometrySink&) const override;
    std::optional<RawHit> intersect(const Ray&) const override;
    void surface(const RawHit&, const Ray&, SurfaceHit&) const override;
    void parametrize(const RawHit&, const Ray&, SurfaceHit&) const override;
    std::optional<SurfacePatch> patch(const SurfaceHit&, Vec3d origin, Vec3d direction) const noexcept override;
    Relief relief() const override { return Relief::smooth; }
    const SurfaceSampling* sampling() const override { return this; }
    double area() const override { return area_; }
    std::optional<ShapeSample> sample(const Receiver&, std::uint32_t part, Vec2 u) const override;
    float pdfSolidAngle(const Receiver&, const SurfaceHit&) const override;
    // Even per area of the shape itself.
    std::optional<ShapePoint> samplePoint(std::uint32_t part, Vec2 u) const override;
    float pdfPoint(std::uint32_t part, Vec3 ng) const override;
    EmitterPart emitterPart(std::uint32_t) const override { return {.box = bounds(), .area = area()}; }
    std::optional<RawHit> locate(Vec3, std::uint32_t, const Ray& towards) const override { return intersect(towards); }
    std::optional<UvPoint> uvPoint(Vec2 uv) const override;

  private:
    SurfaceHit pointInRender(Vec3 p, Vec3 pError, Vec3 ng) const;
    double directionJacobian(Vec3 objectDirection) const;
    void setBounds(Vec3d centre, Vec3d halfExtent);

    std::unique_ptr<const Shape> shape_;
    Instance map_;
    Transform inverse_;
    double determinant_;
    Bounds3 bounds_;
    double area_ = 0;
};

} // namespace abbe
