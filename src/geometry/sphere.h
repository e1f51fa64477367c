// Spheres, intersected and sampled in double.
#pragma once

#include "render/shape.h"

namespace abbe {

// Poles on the y axis: u is the longitude / 2π from +z towards +x, v rises from the south pole to the north.
// Requires radius > 0. Rays may have directions of any length (under instances).
class Sphere final : public Shape {
  public:
    Sphere(Vec3d centre, double radius);

    Vec3d centre() const { return centre_; }
    double radius() const { return radius_; }

    Bounds3 bounds() const override;
    void commit(GeometrySink&) const override;
    std::optional<RawHit> intersect(const Ray&) const override;
    void surface(const RawHit&, const Ray&, SurfaceHit&) const override;
    double area() const override;
    // From outside: uniform in the cone of directions that meet the sphere. From inside: uniform per area.
    std::optional<ShapeSample> sample(const Receiver&, std::uint32_t part, Vec2 u) const override;
    float pdfSolidAngle(const Receiver&, const SurfaceHit&) const override;

  private:
    ShapeSample at(Vec3d normal) const; // without density

    Vec3d centre_;
    double radius_;
    double magnitude_; // largest coordinate in size
};

} // namespace abbe
