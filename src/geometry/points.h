// Clouds of small spheres or disks: spray, dust, scans, particles.
#pragma once

#include "render/shape.h"

#include <vector>

namespace abbe {

struct PointData {
    PointForm form = PointForm::sphere;
    std::vector<SizedPoint> points;
    std::vector<Vec3> normals; // unit, one per point of oriented disks
    // Both at further time steps (see TimeSteps), after those at the first; none: all stands still.
    struct Step {
        std::vector<SizedPoint> points;
        std::vector<Vec3> normals;
    };
    std::vector<Step> later = {};
};

// Points without width at all times are left out. The primitive of a hit is the point's number among those that remain.
// Texture coordinates: of a sphere those of Sphere; of a disk distance / radius and angle / 2π, for disks that turn to
// the ray about a frame that turns with them.
class Points final : public Shape {
  public:
    // Requires finite positions, finite radii >= 0, and unit normals for oriented disks; as many of each at every time
    // step, at most kMaxTimeSteps of them.
    explicit Points(PointData);

    std::size_t count() const { return data_.points.size(); }
    std::size_t omitted() const { return omitted_; }
    std::size_t bytes() const; // of the data that rays refer to, without the acceleration structure

    Bounds3 bounds() const override { return bounds_; } // at all times
    void commit(GeometrySink&) const override;
    void surface(const RawHit&, const Ray&, SurfaceHit&) const override;
    void parametrize(const RawHit&, const Ray&, SurfaceHit&) const override;
    Vec3 carried(const RawHit&, const Ray&, const SurfaceHit&, float time) const override;
    double area() const override; // at first

  private:
    void removeInvisible();
    void addBounds(const std::vector<SizedPoint>&);
    SizedPoint pointAt(std::uint32_t, float time) const;
    Vec3 normalAt(std::uint32_t, float time) const;
    void sphere(const SizedPoint&, Vec3d o, Vec3d d, double t, SurfaceHit&) const;
    void disk(const SizedPoint&, Vec3 normal, Vec3d o, Vec3d d, SurfaceHit&) const;

    PointData data_;
    std::size_t omitted_ = 0;
    Bounds3 bounds_;
};

} // namespace abbe
