// The triangles of a small scene, tested all at once: up to a few dozen a tree costs more than it saves.
#pragma once

#include "render/ray.h"
#include "render/shape.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace abbe {

// Eight triangles to a step, without a branch. The distance to a plane is computed in double, so that a ray never meets
// the triangle that it starts on, from which it is moved by the bound of the point's error; the place in the plane in
// float. Rays that pass an edge within the rounding of that place count as hits, so that neighbours leave no crack.
// Immutable; the same bits on every machine.
class FewTriangles {
  public:
    static constexpr std::size_t kMost = 96;

    struct Triangle {
        std::array<Vec3, 3> corners;
        std::uint32_t record = 0, primitive = 0; // of the sink's call, and in it
        bool secondHalf = false;                 // of a quad
        Visibility visible;
    };
    // u, v as GeometrySink's primitives have them: of a quad both run from its first corner.
    struct Hit {
        float t = 0, u = 0, v = 0;
        std::uint32_t record = 0, primitive = 0;
    };

    ~FewTriangles();
    // Nothing if there are too many of them, or one that is so small for its distance from the origin that the rounding
    // of places would show.
    static std::unique_ptr<const FewTriangles> make(std::span<const Triangle>);

    // The nearest in (0, tMax], in units of the direction's length. Requires a finite ray.
    std::optional<Hit> intersect(const Ray&) const noexcept;
    bool occluded(const Ray&) const noexcept;

  private:
    struct Lanes;
    struct Rays;
    struct Found;
    static Found test(const Lanes&, const Rays&) noexcept;

    std::vector<Lanes> lanes_;
    std::vector<Triangle> triangles_;
};

// Collects the triangles of shapes that consist of nothing else and stand still, numbered as EmbreeSink numbers its
// records.
class FewTrianglesSink final : public GeometrySink {
  public:
    using GeometrySink::quads, GeometrySink::triangles;

    // False once there is anything that does not fit.
    bool add(const Shape&, Visibility);
    std::unique_ptr<const FewTriangles> make() const { return fits_ ? FewTriangles::make(triangles_) : nullptr; }

    void triangles(TimeSteps<Vec3> vertices, Triangles) override;
    void quads(TimeSteps<Vec3> vertices, Quads) override;
    void curves(CurveBasis, CurveForm, TimeSteps<SizedPoint>, std::span<const std::uint32_t>,
                std::span<const std::uint8_t>) override {
        fits_ = false;
    }
    void points(PointForm, TimeSteps<SizedPoint>, TimeSteps<Vec3>) override { fits_ = false; }
    void analytic(const Bounds3&) override { fits_ = false; }

  private:
    bool begin(std::size_t steps, std::size_t count);

    std::vector<FewTriangles::Triangle> triangles_;
    std::uint32_t records_ = 0;
    Visibility visible_;
    bool fits_ = true;
};

} // namespace abbe
