// All geometry of a scene behind one intersector, by Embree. EmbreeSceneBuilder fills it.
#pragma once

#include "geometry/embree_device.h"
#include "geometry/embree_sink.h"
#include "geometry/instance_table.h"
#include "render/intersector.h"
#include "render/own_space.h"

#include <atomic>
#include <embree3/rtcore.h>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace abbe {

// Where a segment ends for occlusion: the surface that its end point belongs to is met at 1 give or take the rounding
// of Embree's distance, a few ulp.
inline constexpr float kBeforeEnd = 1 - 0x1p-20f;

class EmbreeScene final : public Intersector {
  public:
    bool intersect(const Ray&, SurfaceHit&) const noexcept override;
    bool occluded(const Ray&) const noexcept override;
    bool occluded(Vec3 from, Vec3 to, float time, RayKind kind) const noexcept override {
        return occluded({from, to - from, kBeforeEnd, time, kind});
    }
    std::size_t coincident(const Ray&, const SurfaceHit&, std::span<SurfaceHit>) const noexcept override;
    std::optional<Passage> passage(const Ray&, const SurfaceHit&, float distance) const noexcept override;
    Bounds3 bounds() const override { return bounds_; }
    std::uint64_t rejectedRays() const override { return rejected_.load(std::memory_order_relaxed); }

    EmbreeDevice device;
    std::vector<EmbreeHandle<RTCScene, rtcReleaseScene>> objectScenes;
    EmbreeHandle<RTCScene, rtcReleaseScene> scene;
    std::vector<GeometryRecord> records; // of the top scene by geometry id, then of each object
    std::vector<OwnSpace> ownSpaces;     // GeometryRecord::space
    std::vector<std::unique_ptr<const InstanceTable>> tables;
    Bounds3 bounds_;
    bool moving = false; // anything

  private:
    using Path = std::span<const PlacementStep>; // from the scene to the object that was hit

    const GeometryRecord& recordOf(const RTCHit&, Path) const;
    void surface(const RTCHit&, Path, float distance, const Ray&, SurfaceHit&) const;
    void surfaceInside(const GeometryRecord&, const RawHit&, Path, const Ray&, SurfaceHit&) const;
    void countMotion(const RTCHit&, Path) const;
    void parametrize(const GeometryRecord&, const RawHit&, const Ray&, SurfaceHit&) const;
    bool resolve(RTCRayHit&, RayContext&, const Ray&, SurfaceHit&) const;
    bool recompute(RTCHit&, Path, const Ray&, float& distance) const;
    Passage passage(const RTCHit&, Path, float distance, const Ray&, const SurfaceHit&) const;

    mutable std::atomic<std::uint64_t> rejected_{0};
};

} // namespace abbe
