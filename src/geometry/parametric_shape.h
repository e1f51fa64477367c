// Exact surfaces under any affine map: what cylinders, cones and tori have in common.
#pragma once

#include "math/transform.h"
#include "render/shape.h"

namespace abbe {

// A surface that is stated in its own space, about the y axis and near the origin, and lives in render space under a
// map that may scale its axes differently. All of it is computed in double and rounded to float once, at the end. Rays
// may have directions of any length.
class ParametricShape : public Shape, public SurfaceSampling {
  public:
    Bounds3 bounds() const override { return bounds_; }
    void commit(GeometrySink&) const override;
    std::optional<RawHit> intersect(const Ray&) const override;
    void surface(const RawHit&, const Ray&, SurfaceHit&) const override;
    void parametrize(const RawHit&, const Ray&, SurfaceHit&) const override;
    std::optional<SurfacePatch> patch(const SurfaceHit&, Vec3d origin, Vec3d direction) const noexcept override;
    const SurfaceSampling* sampling() const override { return this; }
    double area() const override { return area_; }
    // Uniform per area of the shape in its own space.
    std::optional<ShapeSample> sample(const Receiver&, std::uint32_t part, Vec2 u) const override;
    float pdfSolidAngle(const Receiver&, const SurfaceHit&) const override;
    std::optional<ShapePoint> samplePoint(std::uint32_t part, Vec2 u) const override;
    float pdfPoint(std::uint32_t part, Vec3 ng) const override;
    EmitterPart emitterPart(std::uint32_t) const override { return {.box = bounds(), .area = area()}; }
    std::optional<RawHit> locate(Vec3, std::uint32_t, const Ray& towards) const override { return intersect(towards); }

  protected:
    // Own space. `part` tells surfaces apart that meet in an edge.
    struct LocalHit {
        double t = 0;
        int part = 0;
    };
    struct LocalPoint {
        Vec3d p;
        Vec3d n;       // unit, outside
        Vec3d tangent; // along u, any length but 0
        Vec2d uv;
    };

    struct LocalDerivatives {
        Vec3d byU, byV; // of the point
    };

    // Requires an invertible map.
    explicit ParametricShape(const Transform& toRender);
    // To be called once by the constructors of derived classes: the bounds, and the areas in own and in render space.
    void finish(const Bounds3d&, double localArea, double area);
    // The box of what remains of a circle about the y axis when a ball of radius `ball` runs along it.
    Bounds3d circleBounds(double y, double radius, double ball) const;
    // Render area per own area where the unit normal in own space is n.
    double stretch(Vec3d n) const { return length(map_.normal(n)); }
    // The same everywhere for maps that keep angles.
    std::optional<double> uniformStretch() const;

    // Nearest hit in (0, tMax]. `d` is of unit length.
    virtual std::optional<LocalHit> intersectLocal(Vec3d o, Vec3d d, double tMax) const = 0;
    // The point of the part that is nearest to p, which is off by rounding only.
    virtual LocalPoint project(Vec3d p, int part) const = 0;
    virtual LocalDerivatives derivatives(const LocalPoint&, int part) const = 0;
    // Uniform per own area.
    virtual LocalPoint sampleLocal(Vec2d u) const = 0;

  private:
    double pdfArea(Vec3d renderNormal) const;

    Transform map_, inverse_;
    double determinant_;
    Bounds3 bounds_;
    double magnitude_ = 0; // largest coordinate in size
    double localArea_ = 0, area_ = 0;
};

} // namespace abbe
