// Flat shapes: infinite planes, four-cornered patches (the usual wall, floor or area light), and boxes, as meshes of
// six quads.
#pragma once

#include "geometry/shape_params.h"
#include "math/mesh_data.h"
#include "math/transform.h"
#include "render/shape.h"

#include <optional>

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

// Corners in order, counter-clockwise seen from outside. Traced as the two triangles (p00, p10, p01) and
// (p11, p01, p10); uv runs from p00 to p10 (u) and to p01 (v). Requires finite corners and a nonzero area.
class Quad final : public Shape, public SurfaceSampling {
  public:
    // `mirrored`: the corners were turned round, because the map that placed them is a mirror.
    Quad(Vec3 p00, Vec3 p10, Vec3 p11, Vec3 p01, bool mirrored = false);

    Bounds3 bounds() const override;
    void commit(GeometrySink&) const override;
    void surface(const RawHit&, const Ray&, SurfaceHit&) const override;
    void parametrize(const RawHit&, const Ray&, SurfaceHit&) const override;
    std::optional<SurfacePatch> patch(const SurfaceHit&, Vec3d origin, Vec3d direction) const noexcept override;
    const SurfaceSampling* sampling() const override { return this; }
    double area() const override { return area_; }
    EmitterPart emitterPart(std::uint32_t) const override;
    // Rectangles seen large: uniform per solid angle, or, for receivers lit from one side, about in proportion to the
    // cosine there; everything else: uniform per area.
    std::optional<ShapeSample> sample(const Receiver&, std::uint32_t part, Vec2 u) const override;
    float pdfSolidAngle(const Receiver&, const SurfaceHit&) const override;
    std::optional<ShapePoint> samplePoint(std::uint32_t part, Vec2 u) const override;
    float pdfPoint(std::uint32_t, Vec3) const override { return pdfArea_; }
    std::optional<RawHit> locate(Vec3 p, std::uint32_t part, const Ray&) const override;
    std::optional<UvPoint> uvPoint(Vec2 uv) const override;

  private:
    // One of the two triangles: p = corner + s edgeS + t edgeT.
    struct Half {
        Vec3 corner, edgeS, edgeT;
        Frame frame; // z is the normal
    };
    // What sampling per solid angle needs.
    struct Rectangle {
        Vec3 x, y, z; // orthonormal
        float width, height;
        Vec3 centre;
        float diagonalSquared;
    };
    static std::optional<Rectangle> asRectangle(const std::array<Vec3, 4>&);
    void sampleArea(Vec2 u, Vec3& p, Vec3& ng) const;

    std::array<Half, 2> halves_;
    Vec3 pError_;
    std::array<Vec3, 5> corners_; // the last is padding for Embree's 16-byte loads
    std::optional<Rectangle> rectangle_;
    double area_;
    float pdfArea_;
    float firstHalf_; // share of the area in halves_[0]
    bool mirrored_;
};

struct QuadParams : ShapeParams {
    std::vector<Vec3d> points; // four corners, or empty
    Vec2d size{1, 1};
};

schema::TypeInfo quadType();
UnplacedShape makeQuad(const QuadParams&, const ShapeContext&);
// From four corners or, without any, a rectangle of the size about the origin. Null after an error located at `span`.
std::unique_ptr<const Shape> placeQuad(const std::vector<Vec3d>& points, Vec2d size, const Transform& place, Span,
                                       Diagnostics&);

// Closed, faces outwards, in the order -x, +x, -y, +y, -z, +z. Requires lower < upper on every axis.
MeshData boxMesh(Vec3d lower, Vec3d upper);

struct BoxParams : ShapeParams {
    Vec3d center;
    std::optional<Vec3d> size; // unset, and no corners: 1 1 1
    std::optional<Vec3d> min, max;
};

schema::TypeInfo boxType();
// Nothing after an error.
std::optional<UnplacedShape> makeBox(const BoxParams&, const ShapeContext&);

} // namespace abbe
