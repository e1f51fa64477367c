// Flat round disks.
#pragma once

#include "render/shape.h"

namespace abbe {

// u is the distance from the centre / radius, v the angle / 2π. Requires normal != 0, radius > 0. Rays may have
// directions of any length.
class Disk final : public Shape {
  public:
    Disk(Vec3d centre, Vec3d normal, double radius);

    Vec3d centre() const { return centre_; }
    Vec3d normal() const { return z_; }
    double radius() const { return radius_; }

    Bounds3 bounds() const override;
    void commit(GeometrySink&) const override;
    std::optional<RawHit> intersect(const Ray&) const override;
    void surface(const RawHit&, const Ray&, SurfaceHit&) const override;
    double area() const override { return kPiD * radius_ * radius_; }
    // Uniform per area.
    std::optional<ShapeSample> sample(const Receiver&, std::uint32_t part, Vec2 u) const override;
    float pdfSolidAngle(const Receiver&, const SurfaceHit&) const override;

  private:
    Vec3d centre_, x_, y_, z_;
    double radius_;
    double magnitude_; // largest coordinate in size
};

} // namespace abbe
