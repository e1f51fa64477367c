// Rays against everything: the only way by which the path loop sees geometry.
#pragma once

#include "math/bounds.h"
#include "render/ray.h"
#include "render/surface_hit.h"

#include <cstdint>
#include <optional>
#include <span>

namespace abbe {

// Where one point of a surface is when the shutter opens and when it closes.
struct Passage {
    Vec3 opening, closing;
};

// Thread-safe. Rays that are not finite are never traced: they miss, and are counted.
class Intersector {
  public:
    virtual ~Intersector() = default;
    // Nearest hit in (0, tMax]; fills `hit` and returns true, or returns false.
    virtual bool intersect(const Ray&, SurfaceHit& hit) const noexcept = 0;
    // The faces of other shapes of dielectrics that lie where `hit`, found along this ray, lies, to within rounding: a
    // ray that goes on from it would miss them. At most others.size(); their number.
    virtual std::size_t coincident(const Ray&, const SurfaceHit& hit, std::span<SurfaceHit> others) const noexcept {
        static_cast<void>(hit), static_cast<void>(others);
        return 0;
    }
    // Of the point of `hit`, which the ray hits at the end of `distance`; nothing if it is not found again.
    virtual std::optional<Passage> passage(const Ray&, const SurfaceHit& hit, float distance) const noexcept {
        static_cast<void>(hit), static_cast<void>(distance);
        return std::nullopt;
    }
    // True if anything lies in (0, tMax).
    virtual bool occluded(const Ray&) const noexcept = 0;
    // True if anything lies between two points: a shadow ray without the cost of a unit direction.
    virtual bool occluded(Vec3 from, Vec3 to, float time, RayKind kind) const noexcept = 0;
    bool occluded(Vec3 from, Vec3 to, float time) const noexcept { return occluded(from, to, time, RayKind::shadow); }
    // Of all finite geometry (infinite planes left out), in render space.
    virtual Bounds3 bounds() const = 0;
    virtual std::uint64_t rejectedRays() const = 0;
};

} // namespace abbe
