// Spheres, intersected and sampled in double.
#pragma once

#include "geometry/shape_params.h"
#include "math/transform.h"
#include "render/shape.h"

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
    Relief relief() const override { return Relief::smooth; }
    const SurfaceSampling* sampling() const override { return this; }
    double area() const override;
    // From outside: uniform in the cone of directions that meet the sphere. From inside: uniform per area.
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

} // namespace abbe
