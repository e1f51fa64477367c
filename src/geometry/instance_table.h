// Placements of one object in one Embree scene, as the primitives of one user geometry.
#pragma once

#include "geometry/instance.h"
#include "math/motion.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <embree3/rtcore.h>
#include <span>
#include <vector>

namespace abbe {

class InstanceTable;

// Objects inside objects inside …: how deep at most.
inline constexpr int kMaxInstanceLevels = 32;

// One step from a scene into an object.
struct PlacementStep {
    const InstanceTable* table;
    std::uint32_t index;

    Placement placement(float time) const; // Ray::time
};

// Embree's context of one ray, and the way to its nearest hit so far: steps [0, depth of the hit), outermost first. The
// depth is in the hit's instID[0], which Embree copies from the context at every hit of its own.
struct RayContext {
    explicit RayContext(std::atomic<std::uint64_t>& rejectedRays) : rejected(rejectedRays) {
        rtcInitIntersectContext(&rtc);
        rtc.instID[0] = 0;
    }
    std::span<const PlacementStep> path(const RTCHit& hit) const { return {steps.data(), hit.instID[0]}; }

    bool skips(const Shape* shape) const {
        for (int i = 0; i < skippedCount; ++i)
            if (skipped[static_cast<std::size_t>(i)] == shape) return true;
        return false;
    }

    RTCIntersectContext rtc; // first: Embree hands its address to the callbacks
    std::atomic<std::uint64_t>& rejected;
    std::array<PlacementStep, kMaxInstanceLevels> steps; // only those of a hit are ever written or read
    // Shapes that the ray does not see: meshes of dielectrics, if they are built for it, and analytic shapes.
    static constexpr int kMaxSkipped = 8;
    std::array<const Shape*, kMaxSkipped> skipped;
    int skippedCount = 0;
};

// Immutable once attached; the callbacks may run in any number of threads. Rays inside an object have the same
// parameter t as outside, so the nearest hit of all is found without comparing distances between spaces.
class InstanceTable {
  public:
    // Requires a committed scene that outlives the table, at least one placement, and fewer than 2^32 of them.
    // `firstRecord` and `firstInstance` are for whoever reads hits.
    InstanceTable(RTCScene object, std::vector<Placement> placements, std::size_t firstRecord,
                  std::uint64_t firstInstance);
    // Objects that move: rays see them where they are at the time of the ray.
    InstanceTable(RTCScene object, std::vector<Motion> motions, Interval shutter, std::size_t firstRecord,
                  std::uint64_t firstInstance);
    InstanceTable(const InstanceTable&) = delete;
    InstanceTable& operator=(const InstanceTable&) = delete;

    // A user geometry with a primitive per placement, of which rays see what they see of the object and of the
    // placements; the table must not move any more.
    void attach(RTCDevice, RTCScene, std::size_t geometryId, Visibility) const;

    std::size_t size() const { return motions_.empty() ? placements_.size() : motions_.size(); }
    RTCScene object() const { return object_; }
    // Whether it places as another one does, be it the same object or not.
    bool placesAs(std::span<const Placement> placements) const {
        return motions_.empty() && std::ranges::equal(placements_, placements);
    }
    bool placesAs(std::span<const Motion> motions, Interval shutter) const {
        return std::ranges::equal(motions_, motions) && shutter_ == shutter;
    }
    bool moves() const { return !motions_.empty(); }
    Placement placement(std::uint32_t i, float time) const {
        return motions_.empty() ? placements_[i] : movedTo(i, static_cast<double>(time));
    }
    std::size_t firstRecord() const { return firstRecord_; }
    std::uint64_t firstInstance() const { return firstInstance_; }
    // Of all placements of a box in object space.
    Bounds3 bounds(const Bounds3& object) const;

  private:
    InstanceTable(RTCScene object, std::size_t firstRecord, std::uint64_t firstInstance); // without placements
    RayLanes enter(std::uint32_t i, const RayLanes& outside, float time) const {
        return motions_.empty() ? placements_[i].toObject(outside)
                                : movedTo(i, static_cast<double>(time)).toObject(outside);
    }
    Placement movedTo(std::uint32_t i, double position) const; // at a position in the shutter interval
    Bounds3 boundsAround(std::uint32_t i, unsigned step, const Bounds3& object) const;
    static void boundsCallback(const RTCBoundsFunctionArguments*);
    static void intersectCallback(const RTCIntersectFunctionNArguments*);
    static void occludedCallback(const RTCOccludedFunctionNArguments*);

    // Whether to follow a ray into the object; rays that cannot be traced are counted.
    bool mayEnter(const RTCRay&, const RayLanes& inside, RayContext&) const;

    RTCScene object_;
    Float4 lower_, upper_;              // bounds of Embree's scene, infinite shapes included
    std::vector<Placement> placements_; // or, where they move,
    std::vector<Motion> motions_;
    Interval shutter_;
    std::size_t firstRecord_;
    std::uint64_t firstInstance_;
};

inline Placement PlacementStep::placement(float time) const { return table->placement(index, time); }

// Coordinates beyond this make Debian's Embree stop the process; NaN fails every comparison.
[[gnu::always_inline]] inline bool isTraceable(const Ray& ray) {
    constexpr float largest = 1e18f;
    const Vec3 o = abs(ray.origin), d = abs(ray.direction);
    return o.x + o.y + o.z < largest && d.x + d.y + d.z < largest && ray.tMax >= 0 && ray.time >= 0 && ray.time <= 1;
}

} // namespace abbe
