// Flat round disks.
#pragma once

#include "geometry/shape_params.h"
#include "math/transform.h"
#include "render/shape.h"

namespace abbe {

// u is the distance from the centre / radius, v the angle / 2π. Requires normal != 0, radius > 0. Rays may have
// directions of any length.
class Disk final : public Shape, public SurfaceSampling {
  public:
    Disk(Vec3d centre, Vec3d normal, double radius);
    // Of what this map, which keeps angles, makes of a disk in its own space: the angle that textures see starts and
    // turns as it does there.
    Disk(Vec3d centre, Vec3d normal, double radius, const Transform& place);

    Vec3d centre() const { return centre_; }
    Vec3d normal() const { return z_; }
    double radius() const { return radius_; }

    Bounds3 bounds() const override;
    void commit(GeometrySink&) const override;
    std::optional<RawHit> intersect(const Ray&) const override;
    void surface(const RawHit&, const Ray&, SurfaceHit&) const override;
    void parametrize(const RawHit&, const Ray&, SurfaceHit&) const override;
    std::optional<SurfacePatch> patch(const SurfaceHit&, Vec3d origin, Vec3d direction) const noexcept override;
    Relief relief() const override { return Relief::smooth; }
    EmitterPart emitterPart(std::uint32_t) const override {
        return {.box = bounds(), .area = area(), .axis = Vec3(z_), .cosNormals = 1};
    }
    const SurfaceSampling* sampling() const override { return this; }
    double area() const override { return kPiD * radius_ * radius_; }
    // Uniform per area.
    std::optional<ShapeSample> sample(const Receiver&, std::uint32_t part, Vec2 u) const override;
    float pdfSolidAngle(const Receiver&, const SurfaceHit&) const override;
    std::optional<ShapePoint> samplePoint(std::uint32_t part, Vec2 u) const override;
    float pdfPoint(std::uint32_t, Vec3) const override { return static_cast<float>(1 / area()); }
    std::optional<RawHit> locate(Vec3, std::uint32_t, const Ray& towards) const override { return intersect(towards); }
    std::optional<UvPoint> uvPoint(Vec2 uv) const override;

  private:
    Vec3d centre_, x_, y_, z_;
    Vec3d textureX_, textureY_; // axes of the angle for textures
    double radius_;
    double magnitude_; // largest coordinate in size
};

// uv, dpdu and dpdv of a disk at x and y along two orthonormal axes.
void parametrizeDisk(double x, double y, double radius, Vec3d axisX, Vec3d axisY, SurfaceHit&);
// Two axes across a normal, as a shape in its own space has them, after the map that took it there. `normal` is that
// after the map.
std::pair<Vec3d, Vec3d> axesAfter(const Transform& place, Vec3d normal);

struct DiskParams : ShapeParams {
    Vec3d center;
    std::optional<Vec3d> normal; // unset: up
    double radius = 0.5;
};

schema::TypeInfo diskType();
UnplacedShape makeDisk(const DiskParams&, const ShapeContext&);
// Null after an error located at `span`.
std::unique_ptr<const Shape> placeDisk(Vec3d center, Vec3d normal, double radius, const Transform& place, Span,
                                       Diagnostics&);

} // namespace abbe
