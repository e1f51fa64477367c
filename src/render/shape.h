// The interfaces of shapes: geometry that rays can hit and, if it emits, that can be sampled.
#pragma once

#include "math/bounds.h"
#include "render/ray.h"
#include "render/receiver.h"
#include "render/surface_hit.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

// What light paths are sent to. A shape whose material focuses light (Material::focuses()).
struct FocusingShape {
    Bounds3 box;      // for all the time that the shutter is open, m, render space; infinite where it is not known
    std::string name; // as in Scene::names
};

// What the acceleration structure knows of a hit. `part` counts the sink calls of the shape's commit.
struct RawHit {
    float u = 0, v = 0;
    float distance = 0;
    std::uint32_t primitive = 0;
    std::uint32_t part = 0;
};

// A point on a shape seen from somewhere. The density is per solid angle at that place.
struct ShapeSample {
    ShapeSample(Vec3 point, Vec3 error, Vec3 normal, float pdf)
        : p(point), pError(error), ng(normal), pdfSolidAngle(pdf) {}

    Vec3 p;
    Vec3 pError;
    Vec3 ng; // unit, outside
    float pdfSolidAngle;
};

// A point of a shape, drawn with no regard to where it is seen from.
struct ShapePoint {
    Vec3 p;
    Vec3 pError;
    Vec3 ng;           // unit, outside
    float pdfArea = 0; // 1/m²
};

// A point by its texture coordinates, and m² per unit of them there.
struct UvPoint {
    Vec3 p;
    Vec3 pError;
    Vec3 ng; // unit, outside
    float area = 0;
};

// What choosing among emitting parts needs to know. All normals are within acos(cosNormals) of the axis.
struct EmitterPart {
    Bounds3 box;
    double area = 0;       // m²
    Vec3 axis{0, 0, 1};    // unit
    float cosNormals = -1; // -1: all directions
};

// A control point of a curve, or a sphere or disk on its own: laid out as Embree reads it.
struct SizedPoint {
    Vec3 position;
    float radius = 0;
};

// What a segment does with its control points: two for linear, four for the others.
enum class CurveBasis : std::uint8_t { linear, bspline, catmullRom, bezier };
// Round: a tube, open at its ends; linear ones are spheres swept along the segment. Flat: a ribbon that turns to the
// ray.
enum class CurveForm : std::uint8_t { round, flat };
// Which of a linear segment's neighbours continue it, as bits: inside, their common sphere is no surface.
enum CurveNeighbour : std::uint8_t { kPreviousSegment = 1, kNextSegment = 2 };
// Disks turn to the ray; oriented ones to their normal.
enum class PointForm : std::uint8_t { sphere, disk, orientedDisk };

// What Shape::patch() knows of a shape.
enum class Relief : std::uint8_t {
    unknown, // nothing: there are no patches
    smooth,  // normals turn steadily, but for some edges
    facets,  // flat pieces with edges between them; emitterParts() tells how many
};

class Shape;

// What holds all over a shape: fixed when it is made.
struct ShapeTraits {
    Relief relief = Relief::unknown;
    bool hasTextureCoordinates = true; // uv are texture coordinates of the whole shape
    bool usesTextures = false;         // some of its faces have a material of their own that looks at textures
    const Shape* primitives = nullptr; // whose primitives these are, where that is another shape, which is part of it
};

class SurfaceSampling;
class VertexAttributes;

// Data of the same primitives at equally spaced times, the first when the shutter opens (Ray::time 0), the last when it
// closes (1); in between all moves in straight lines. One: it stands still. As long as the first at every step.
template <typename T> using TimeSteps = std::span<const std::span<const T>>;
inline constexpr std::size_t kMaxTimeSteps = 129;

// Receives a shape's primitives. Data are copied or kept by reference until the shape is gone (see EmbreeScene).
class GeometrySink {
  public:
    using Triangles = std::span<const std::array<std::uint32_t, 3>>;
    using Quads = std::span<const std::array<std::uint32_t, 4>>;

    virtual ~GeometrySink() = default;
    virtual void triangles(TimeSteps<Vec3> vertices, Triangles) = 0;
    virtual void quads(TimeSteps<Vec3> vertices, Quads) = 0;
    // Segment i has the control points from `firstPoints[i]` on. `neighbours` has an entry per segment for round linear
    // curves, else none.
    virtual void curves(CurveBasis, CurveForm, TimeSteps<SizedPoint> points, std::span<const std::uint32_t> firstPoints,
                        std::span<const std::uint8_t> neighbours) = 0;
    // A normal per point for oriented disks, at each step, else none.
    virtual void points(PointForm, TimeSteps<SizedPoint>, TimeSteps<Vec3> normals) = 0;
    // One primitive that intersects itself through Shape::intersect.
    virtual void analytic(const Bounds3&) = 0;

    // What stands still.
    void triangles(std::span<const Vec3> vertices, Triangles indices) { triangles({&vertices, 1}, indices); }
    void quads(std::span<const Vec3> vertices, Quads indices) { quads({&vertices, 1}, indices); }
};

// The interface of every shape. Immutable after construction; methods are thread-safe and do not throw. Coordinates are
// those in which the shape was made: render space, or an object's space under an instance.
class Shape {
  public:
    virtual ~Shape() = default;
    virtual Bounds3 bounds() const = 0;
    virtual void commit(GeometrySink&) const = 0;
    // Nearest hit in (0, ray.tMax] of an analytic primitive. Only called for parts given to GeometrySink::analytic.
    virtual std::optional<RawHit> intersect(const Ray&) const { return std::nullopt; }
    // Whether a hit that was found in float is there. Only called for round linear curves, for which Embree reports
    // hits on rays that leave. `distance` and the ray's direction may be in any unit.
    virtual bool confirms(const RawHit&, const Ray&) const { return true; }
    // Fills p, pError, ng, shading, uv and primitive of the hit.
    virtual void surface(const RawHit&, const Ray&, SurfaceHit&) const = 0;
    // Completes a hit that surface() has filled, for materials that look at textures: dpdu and dpdv, which are 0
    // before; uv where those of surface() do not turn with the shape; and `local`, the point before, where the shape
    // deforms: as it was when the shutter opened. All in the shape's coordinates.
    virtual void parametrize(const RawHit&, const Ray&, SurfaceHit&) const {}
    // Where the point of a hit that surface() has filled is at another time (Ray::time), in the shape's coordinates.
    virtual Vec3 carried(const RawHit&, const Ray&, const SurfaceHit& hit, float /*time*/) const { return hit.p; }
    // The mean of the two curvatures of the shading normals at a hit of this shape, 1/m; positive where it bulges
    // outwards, 0 where it is not known. For the width of paths beyond mirrors and lenses.
    virtual float meanCurvature(const SurfaceHit&) const { return 0; }
    // The surface at a hit of this shape, where the line meets it that runs through `origin` in the direction
    // `direction` and has led to the hit up to rounding; nothing if it passes by, or always for Relief::unknown. In the
    // shape's coordinates.
    virtual std::optional<SurfacePatch> patch(const SurfaceHit&, Vec3d /*origin*/, Vec3d /*direction*/) const noexcept {
        return std::nullopt;
    }
    // m²; infinite for planes.
    virtual double area() const = 0;
    // What some shapes can besides; null for those that cannot.
    virtual const SurfaceSampling* sampling() const { return nullptr; }
    virtual const VertexAttributes* attributes() const { return nullptr; }

    Relief relief() const { return traits_.relief; }
    bool hasTextureCoordinates() const { return traits_.hasTextureCoordinates; }
    bool usesTextures() const { return traits_.usesTextures; }
    // What acceleration structures know it by: the same as long as commit() says the same, whatever its materials.
    const Shape& primitives() const { return traits_.primitives ? *traits_.primitives : *this; }

  protected:
    explicit Shape(ShapeTraits traits = {}) : traits_(traits) {}

  private:
    ShapeTraits traits_;
};

// Of a shape on which points can be drawn: for lights, and for chains of refractions that lead through it.
class SurfaceSampling {
  public:
    // What is sampled at a time: the whole shape, or each of the polygons of a mesh; the part of a hit is then its
    // SurfaceHit::primitive.
    virtual std::uint32_t emitterParts() const { return 1; }
    virtual EmitterPart emitterPart(std::uint32_t) const = 0;
    // A point of a part seen from `from`, or nothing if none can be (degenerate, below the horizon). All points that
    // count there have a density. u in [0, 1)².
    virtual std::optional<ShapeSample> sample(const Receiver& from, std::uint32_t part, Vec2 u) const = 0;
    // Density with which sample(from, part of the hit, ·) makes the point of `hit`, which lies on this shape; 0 if it
    // cannot.
    virtual float pdfSolidAngle(const Receiver& from, const SurfaceHit& hit) const = 0;

    // What paths that start at an emitter need. A point of a part, even per area where the shape was made. u in
    // [0, 1)².
    virtual std::optional<ShapePoint> samplePoint(std::uint32_t part, Vec2 u) const = 0;
    // Density per m² with which samplePoint(part, ·) makes a point of the part where the unit normal is ng; 0 if it
    // cannot.
    virtual float pdfPoint(std::uint32_t part, Vec3 ng) const = 0;

    // What only emitters with textures need. What surface() and parametrize() are to be given at a point of a part,
    // where the normal is ng; nothing if it is not on the shape. The ray is the one to go with it.
    virtual std::optional<RawHit> locate(Vec3 p, std::uint32_t part, const Ray& towards) const = 0;
    // The point whose texture coordinates are these, where parametrize() maps the shape one to one to the unit square.
    virtual std::optional<UvPoint> uvPoint(Vec2 /*uv*/) const { return std::nullopt; }

  protected:
    ~SurfaceSampling() = default; // owned as shapes
};

// Of any shape: what the shape itself says or, where nothing can be drawn on it, that: such a light is found by rays
// alone.
class SamplingOf final {
  public:
    // Refers to the shape.
    explicit SamplingOf(const Shape& shape) : none_(shape), sampling_(shape.sampling()) {}
    const SurfaceSampling& operator*() const { return sampling_ ? *sampling_ : none_; }
    const SurfaceSampling* operator->() const { return &**this; }

  private:
    class None final : public SurfaceSampling {
      public:
        explicit None(const Shape& shape) : shape_(shape) {}
        EmitterPart emitterPart(std::uint32_t) const override {
            return {.box = shape_.bounds(), .area = shape_.area()};
        }
        std::optional<ShapeSample> sample(const Receiver&, std::uint32_t, Vec2) const override { return std::nullopt; }
        float pdfSolidAngle(const Receiver&, const SurfaceHit&) const override { return 0; }
        std::optional<ShapePoint> samplePoint(std::uint32_t, Vec2) const override { return std::nullopt; }
        float pdfPoint(std::uint32_t, Vec3) const override { return 0; }
        std::optional<RawHit> locate(Vec3, std::uint32_t, const Ray& towards) const override {
            return shape_.intersect(towards);
        }

      private:
        const Shape& shape_;
    };

    None none_;
    const SurfaceSampling* sampling_;
};

// Of a shape with numbers at its vertices, which are blended between them.
class VertexAttributes {
  public:
    // The attribute of that name at a hit of this shape, found by part, element and barycentric; nothing if it has
    // none. A single channel is repeated.
    virtual std::optional<Vec3> attribute(std::string_view, const SurfaceHit&) const = 0;
    virtual std::vector<std::string_view> attributeNames() const = 0;

  protected:
    ~VertexAttributes() = default; // owned as shapes
};

// The ray that hits a point of a shape from its outer side, from so near that nothing else is in between, as a rule.
inline Ray rayOnto(Vec3 p, Vec3 ng, float nearness) {
    Ray ray;
    ray.origin = p + ng * nearness;
    ray.direction = -ng;
    ray.tMax = 2 * nearness;
    return ray;
}

} // namespace abbe
