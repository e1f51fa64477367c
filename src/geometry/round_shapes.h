// Round shapes: spheres, intersected and sampled in double, and flat round disks; and what maps that do not keep them
// round make of them: ellipsoids and ellipses.
#pragma once

#include "geometry/instance.h"
#include "geometry/shape_params.h"
#include "math/transform.h"
#include "render/shape.h"

#include <memory>

namespace abbe {

// Poles on the y axis: u is the longitude / 2π from +z towards +x, v rises from the south pole to the north. Those
// textures see are about the axes of the shape's own space.
// Requires radius > 0. Rays may have directions of any length (under instances).
class Sphere final : public Shape, public SurfaceSampling {
  public:
    Sphere(Vec3d centre, double radius);
    // Of what this map, which keeps angles, makes of a sphere in its own space.
    Sphere(Vec3d centre, double radius, const Transform& place);

    Vec3d centre() const { return centre_; }
    double radius() const { return radius_; }

    Bounds3 bounds() const override;
    void commit(GeometrySink&) const override;
    std::optional<RawHit> intersect(const Ray&) const override;
    void surface(const RawHit&, const Ray&, SurfaceHit&) const override;
    void parametrize(const RawHit&, const Ray&, SurfaceHit&) const override;
    float meanCurvature(const SurfaceHit&) const override { return static_cast<float>(1 / radius_); }
    std::optional<SurfacePatch> patch(const SurfaceHit&, Vec3d origin, Vec3d direction) const noexcept override;
    const SurfaceSampling* sampling() const override { return this; }
    double area() const override;
    // From outside: uniform in the cone of directions that hit the sphere. From inside: uniform per area.
    std::optional<ShapeSample> sample(const Receiver&, std::uint32_t part, Vec2 u) const override;
    float pdfSolidAngle(const Receiver&, const SurfaceHit&) const override;
    std::optional<ShapePoint> samplePoint(std::uint32_t part, Vec2 u) const override;
    float pdfPoint(std::uint32_t, Vec3) const override { return static_cast<float>(1 / area()); }
    EmitterPart emitterPart(std::uint32_t) const override { return {.box = bounds(), .area = area()}; }
    std::optional<RawHit> locate(Vec3, std::uint32_t, const Ray& towards) const override { return intersect(towards); }
    std::optional<UvPoint> uvPoint(Vec2 uv) const override;

  private:
    ShapeSample at(Vec3d normal) const; // without density

    Vec3d centre_;
    double radius_;
    double magnitude_;                          // largest coordinate in size
    Vec3 x_{1, 0, 0}, y_{0, 1, 0}, z_{0, 0, 1}; // axes of the own space, of unit length; left-handed after a mirror
};

// uv, dpdu and dpdv of a sphere about these axes where its normal is n.
void parametrizeSphere(Vec3 n, float radius, Vec3 x, Vec3 y, Vec3 z, SurfaceHit&);

struct SphereParams : ShapeParams {
    Vec3d center;
    double radius = 0.5;
};

schema::TypeInfo sphereType();
UnplacedShape makeSphere(const SphereParams&, const ShapeContext&);
// Null after an error located at `span`.
std::unique_ptr<const Shape> placeSphere(Vec3d center, double radius, const Transform& place, Span, Diagnostics&);

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
