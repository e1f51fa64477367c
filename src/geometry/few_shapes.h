// All that a small scene consists of, tested without a tree: up to a few dozen a tree costs more than it saves.
#pragma once

#include "render/ray.h"
#include "render/shape.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace abbe {

// Which of eight lanes rays of a kind see.
class VisibleLanes {
  public:
    static constexpr std::size_t kWidth = 8;

    void set(std::size_t lane, Visibility visible) {
        for (std::size_t r = 0; r < kRayKinds; ++r) rows_[r][lane] = visible.bits() >> r & 1 ? 0xffffffffu : 0;
    }
    static std::size_t row(RayKind kind) {
        return static_cast<std::size_t>(std::countr_zero(static_cast<std::uint32_t>(kind)));
    }
    // All bits or none for each lane, at an address for eight floats.
    const float* masks(std::size_t row) const { return reinterpret_cast<const float*>(rows_[row].data()); }

  private:
    alignas(32) std::array<std::array<std::uint32_t, kWidth>, kRayKinds> rows_{}; // what is not set nobody sees
};

// Triangles and quads, eight to a step, without a branch. The distance to a plane is computed in double, so that a ray
// never meets the polygon that it starts on, from which it is moved by the bound of the point's error; the place in the
// plane in float. Rays that pass an edge within the rounding of that place count as hits, so that neighbours leave no
// crack. Quads that are flat and convex are one plane with four edges; others are two triangles, split as Embree splits
// them. Immutable; the same bits on every machine.
class FewPolygons {
  public:
    static constexpr std::size_t kMost = 96;

    struct Polygon {
        std::array<Vec3, 4> corners; // of a triangle the first three
        bool quad = false;
        std::uint32_t record = 0, primitive = 0; // of the sink's call, and in it
        Visibility visible;
    };
    // u, v as GeometrySink's primitives have them: of a quad both run from its first corner.
    struct Hit {
        float t = 0, u = 0, v = 0;
        std::uint32_t record = 0, primitive = 0;
    };

    ~FewPolygons();
    // Nothing if there are too many of them, or one that is so small for its distance from the origin that the rounding
    // of places would show.
    static std::unique_ptr<const FewPolygons> make(std::span<const Polygon>);

    // The nearest in (0, tMax], in units of the direction's length. Requires a finite ray.
    std::optional<Hit> intersect(const Ray&) const noexcept;
    bool occluded(const Ray&) const noexcept;

  private:
    struct Weights;
    struct Lanes;
    struct QuadLanes;
    struct Rays;
    struct Found;
    class Maker;
    // What a lane stands for.
    struct Owner {
        std::uint32_t record = 0, primitive = 0;
        bool secondHalf = false; // of a quad in two triangles
    };
    template <typename OneLanes> static Found test(const OneLanes&, const Rays&) noexcept;

    std::vector<QuadLanes> quads_; // their lanes are numbered first
    std::vector<Lanes> triangles_;
    std::vector<Owner> owners_; // of lanes
};

// Polygons, all at once, and then those shapes that intersect themselves whose boxes a ray meets. Immutable; refers to
// the shapes. The same bits on every machine.
class FewShapes {
  public:
    static constexpr std::size_t kMostOwn = VisibleLanes::kWidth;

    // A shape with one primitive that intersects itself (GeometrySink::analytic).
    struct Own {
        const Shape* shape = nullptr;
        std::uint32_t record = 0; // of the sink's call
        Visibility visible;
    };
    using Hit = FewPolygons::Hit;

    // Nothing if there is nothing, too much, or what FewPolygons cannot have.
    static std::unique_ptr<const FewShapes> make(std::span<const FewPolygons::Polygon>, std::span<const Own>);

    // As those of FewPolygons. Of two hits at the same distance the own shape's counts.
    std::optional<Hit> intersect(const Ray&) const noexcept;
    bool occluded(const Ray&) const noexcept;

  private:
    // Of the own shapes.
    struct alignas(32) Boxes {
        std::array<std::array<float, kMostOwn>, 3> lower{}, upper{};
        VisibleLanes visible;
    };
    unsigned meets(const Ray&) const noexcept;

    std::unique_ptr<const FewPolygons> polygons_; // null: none
    std::vector<Own> own_;
    Boxes boxes_;
};

// Collects the primitives of shapes that stand still, numbered as EmbreeSink numbers its records.
class FewShapesSink final : public GeometrySink {
  public:
    using GeometrySink::quads, GeometrySink::triangles;

    // False once there is anything that does not fit.
    bool add(const Shape&, Visibility);
    std::unique_ptr<const FewShapes> make() const { return fits_ ? FewShapes::make(polygons_, own_) : nullptr; }

    void triangles(TimeSteps<Vec3> vertices, Triangles) override;
    void quads(TimeSteps<Vec3> vertices, Quads) override;
    void curves(CurveBasis, CurveForm, TimeSteps<SizedPoint>, std::span<const std::uint32_t>,
                std::span<const std::uint8_t>) override {
        fits_ = false;
    }
    void points(PointForm, TimeSteps<SizedPoint>, TimeSteps<Vec3>) override { fits_ = false; }
    void analytic(const Bounds3&) override;

  private:
    template <std::size_t corners>
    void addPolygons(TimeSteps<Vec3> vertices, std::span<const std::array<std::uint32_t, corners>> indices);

    std::vector<FewPolygons::Polygon> polygons_;
    std::vector<FewShapes::Own> own_;
    std::uint32_t records_ = 0;
    const Shape* shape_ = nullptr; // that is being added
    Visibility visible_;
    bool fits_ = true;
};

} // namespace abbe
