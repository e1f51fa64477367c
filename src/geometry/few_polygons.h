// The triangles and quads of a small scene, tested all at once: up to a few dozen a tree costs more than it saves.
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

// Eight to a step, without a branch. The distance to a plane is computed in double, so that a ray never meets the
// polygon that it starts on, from which it is moved by the bound of the point's error; the place in the plane in float.
// Rays that pass an edge within the rounding of that place count as hits, so that neighbours leave no crack. Quads that
// are flat and convex are one plane with four edges; others are two triangles, split as Embree splits them. Immutable;
// the same bits on every machine.
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

} // namespace abbe
