// All that a small scene consists of, tested without a tree.
#pragma once

#include "geometry/few_polygons.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace abbe {

// Polygons, all at once, and then those shapes that intersect themselves whose boxes a ray meets. Immutable; refers to
// the shapes. The same bits on every machine.
class FewShapes {
  public:
    static constexpr std::size_t kMostOwn = 8;

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
    // Of the own shapes; a lane that is not filled is seen by no ray.
    struct alignas(32) Boxes {
        std::array<std::array<float, kMostOwn>, 3> lower{}, upper{};
        std::array<std::array<std::uint32_t, kMostOwn>, kRayKinds> visible{};
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
    void add(TimeSteps<Vec3> vertices, std::span<const std::array<std::uint32_t, corners>> indices);

    std::vector<FewPolygons::Polygon> polygons_;
    std::vector<FewShapes::Own> own_;
    std::uint32_t records_ = 0;
    const Shape* shape_ = nullptr; // that is being added
    Visibility visible_;
    bool fits_ = true;
};

} // namespace abbe
