#include "geometry/instance_table.h"

#include "base/check.h"
#include "base/work.h"
#include "geometry/embree_scene.h"

#include <cstddef>

namespace abbe {

namespace {

// Time steps of what moves, for Embree's boxes alone; where an object is comes from its motion.
constexpr unsigned kMotionSteps = 17;

const InstanceTable& tableOf(void* user) { return *static_cast<const InstanceTable*>(user); }

// False only if the ray passes the box. Boxes of turned boxes are larger than needed, so that many rays do, and
// Embree's own test would cost them a call. The factor covers the rounding of the distances [Ize2013].
[[gnu::always_inline]] inline bool mayMeet(Float4 lower, Float4 upper, const RayLanes& ray, float near, float far) {
    const Float4 inverse = 1 / ray.direction;
    const Float4 t0 = (lower - ray.origin) * inverse, t1 = (upper - ray.origin) * inverse;
    // A ray in the plane of a face gives a NaN, which the comparisons below pass over.
    const auto back = t1 < t0;
    const Float4 first = back ? t1 : t0, last = (back ? t0 : t1) * 1.0000004f;
    for (int axis = 0; axis < 3; ++axis) {
        near = first[axis] > near ? first[axis] : near;
        far = last[axis] < far ? last[axis] : far;
    }
    return near <= far;
}

[[gnu::always_inline]] inline bool isTraceable(const RayLanes& ray) {
    return isTraceable(
        Ray{{ray.origin[0], ray.origin[1], ray.origin[2]}, {ray.direction[0], ray.direction[1], ray.direction[2]}});
}

// Origin and direction of a ray, each with the number behind it.
RayLanes lanesOf(const RTCRay& r) {
    RayLanes lanes;
    std::memcpy(&lanes.origin, &r.org_x, sizeof lanes.origin);
    std::memcpy(&lanes.direction, &r.dir_x, sizeof lanes.direction);
    return lanes;
}
void setLanes(RTCRay& r, RayLanes lanes) {
    lanes.origin[3] = r.tnear;
    lanes.direction[3] = r.time;
    std::memcpy(&r.org_x, &lanes.origin, sizeof lanes.origin);
    std::memcpy(&r.dir_x, &lanes.direction, sizeof lanes.direction);
}
static_assert(offsetof(RTCRay, tnear) == offsetof(RTCRay, org_x) + 12);
static_assert(offsetof(RTCRay, time) == offsetof(RTCRay, dir_x) + 12);

RayContext& contextOf(RTCIntersectContext* context) { return *reinterpret_cast<RayContext*>(context); }

} // namespace

InstanceTable::InstanceTable(RTCScene object, std::size_t firstRecord, std::uint64_t firstInstance)
    : object_(object), firstRecord_(firstRecord), firstInstance_(firstInstance) {
    RTCBounds b;
    rtcGetSceneBounds(object, &b);
    lower_ = Float4{b.lower_x, b.lower_y, b.lower_z, 0};
    upper_ = Float4{b.upper_x, b.upper_y, b.upper_z, 0};
}

InstanceTable::InstanceTable(RTCScene object, std::vector<Placement> placements, std::size_t firstRecord,
                             std::uint64_t firstInstance)
    : InstanceTable(object, firstRecord, firstInstance) {
    placements_ = std::move(placements);
    ABBE_CHECK(size() > 0 && size() < 0xffffffffu);
}

InstanceTable::InstanceTable(RTCScene object, std::vector<Motion> motions, Interval shutter, std::size_t firstRecord,
                             std::uint64_t firstInstance)
    : InstanceTable(object, firstRecord, firstInstance) {
    motions_ = std::move(motions);
    shutter_ = shutter;
    ABBE_CHECK(size() > 0 && size() < 0xffffffffu);
}

Placement InstanceTable::movedTo(std::uint32_t i, double position) const {
    const WorkScope work(Work::motion);
    return Placement(motions_[i].at(shutter_.open + position * shutter_.duration));
}

// Embree interpolates boxes linearly between its steps. Each box holds the object over both neighbouring steps, so that
// whatever lies between two boxes holds it, too. In a step the way is sampled; between samples it is as curved as it is
// around them, which twice the largest second difference bounds with a margin.
Bounds3 InstanceTable::boundsAround(std::uint32_t i, unsigned step, const Bounds3& object) const {
    constexpr int samples = 8; // per step
    Bounds3 all, before, previous;
    Vec3 bend;
    for (int k = -samples; k <= samples; ++k) {
        const double position = (step + static_cast<double>(k) / samples) / (kMotionSteps - 1);
        if (position < 0 || position > 1) continue;
        const Bounds3 box = movedTo(i, position).toOuter(object);
        if (!before.empty())
            bend = max(bend, max(abs(before.lower + box.lower - previous.lower * 2),
                                 abs(before.upper + box.upper - previous.upper * 2)));
        all.add(box);
        before = previous;
        previous = box;
    }
    return {all.lower - bend * 2, all.upper + bend * 2};
}

void InstanceTable::attach(RTCDevice device, RTCScene scene, std::size_t geometryId, Visibility visible) const {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(size()));
    if (!motions_.empty()) rtcSetGeometryTimeStepCount(geometry, kMotionSteps);
    rtcSetGeometryUserData(geometry, const_cast<InstanceTable*>(this)); // read back as const
    rtcSetGeometryBoundsFunction(geometry, boundsCallback, nullptr);
    rtcSetGeometryIntersectFunction(geometry, intersectCallback);
    rtcSetGeometryOccludedFunction(geometry, occludedCallback);
    attachGeometry(scene, geometry, geometryId, visible);
}

Bounds3 InstanceTable::bounds(const Bounds3& object) const {
    Bounds3 all;
    if (object.empty()) return all;
    for (const Placement& p : placements_) all.add(p.toOuter(object));
    for (std::uint32_t i = 0; i < motions_.size(); ++i)
        for (unsigned step = 0; step < kMotionSteps; ++step) all.add(boundsAround(i, step, object));
    return all;
}

void InstanceTable::boundsCallback(const RTCBoundsFunctionArguments* args) {
    const InstanceTable& table = tableOf(args->geometryUserPtr);
    const Bounds3 object{{table.lower_[0], table.lower_[1], table.lower_[2]},
                         {table.upper_[0], table.upper_[1], table.upper_[2]}};
    const Bounds3 b = table.motions_.empty() ? table.placements_[args->primID].toOuter(object)
                                             : table.boundsAround(args->primID, args->timeStep, object);
    *args->bounds_o = {b.lower.x, b.lower.y, b.lower.z, 0, b.upper.x, b.upper.y, b.upper.z, 0};
}

bool InstanceTable::mayEnter(const RTCRay& ray, const RayLanes& inside, RayContext& context) const {
    if (!mayMeet(lower_, upper_, inside, ray.tnear, ray.tfar)) return false;
    if (isTraceable(inside)) [[likely]]
        return true;
    context.rejected.fetch_add(1, std::memory_order_relaxed);
    return false;
}

void InstanceTable::intersectCallback(const RTCIntersectFunctionNArguments* args) {
    if (args->N != 1 || args->valid[0] == 0) return;
    const InstanceTable& table = tableOf(args->geometryUserPtr);
    RayContext& context = contextOf(args->context);
    auto& [ray, hit] = *reinterpret_cast<RTCRayHit*>(args->rayhit);
    const RayLanes outside = lanesOf(ray), inside = table.enter(args->primID, outside, ray.time);
    if (!table.mayEnter(ray, inside, context)) return;
    const unsigned outerHit = hit.geomID;
    const unsigned level = context.rtc.instID[0]++;
    hit.geomID = RTC_INVALID_GEOMETRY_ID; // tells a hit in here from one before
    setLanes(ray, inside);
    rtcIntersect1(table.object_, &context.rtc, reinterpret_cast<RTCRayHit*>(args->rayhit));
    setLanes(ray, outside);
    context.rtc.instID[0] = level;
    if (hit.geomID == RTC_INVALID_GEOMETRY_ID)
        hit.geomID = outerHit;
    else
        context.steps[level] = {&table, args->primID};
}

void InstanceTable::occludedCallback(const RTCOccludedFunctionNArguments* args) {
    if (args->N != 1 || args->valid[0] == 0) return;
    const InstanceTable& table = tableOf(args->geometryUserPtr);
    auto& ray = *reinterpret_cast<RTCRay*>(args->ray);
    const RayLanes outside = lanesOf(ray), inside = table.enter(args->primID, outside, ray.time);
    if (!table.mayEnter(ray, inside, contextOf(args->context))) return;
    setLanes(ray, inside);
    rtcOccluded1(table.object_, args->context, &ray); // sets tfar to -∞ for the outer traversal, too
    setLanes(ray, outside);
}

} // namespace abbe
