#include "geometry/embree_scene.h"

#include "base/work.h"
#include "geometry/surface_math.h"
#include "geometry/time_steps.h"
#include "render/material.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace abbe {

namespace {

// False hits dropped on one ray before it is given up as a miss.
constexpr int kMaxRecasts = 32;

void fill(RTCRay& r, const Ray& ray, float tNear) {
    r.org_x = ray.origin.x;
    r.org_y = ray.origin.y;
    r.org_z = ray.origin.z;
    r.tnear = tNear;
    r.dir_x = ray.direction.x;
    r.dir_y = ray.direction.y;
    r.dir_z = ray.direction.z;
    r.time = ray.time;
    r.tfar = ray.tMax;
    r.mask = static_cast<unsigned>(ray.kind);
    r.id = 0;
    r.flags = 0;
}

[[gnu::always_inline]] inline void cast(RTCScene scene, RayContext& context, RTCRayHit& rayHit) {
    const WorkScope work(Work::tracing);
    rayHit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &context.rtc, &rayHit);
}

// How far the hit point is from the ray's line, squared, and where along the ray it is.
struct Deviation {
    float along, offLine2;
};
Deviation deviation(const Ray& ray, const SurfaceHit& hit) {
    const Vec3 e = hit.p - ray.origin;
    const float along = dot(e, ray.direction);
    return {along, lengthSquared(e - ray.direction * along)};
}

// Corners of the triangles that a primitive consists of, in render space: one, or the two halves of a quad.
struct Corners {
    std::array<std::array<Vec3d, 3>, 2> triangle;
    int count = 0;
};
Corners cornersOf(RTCScene scene, const RTCHit& h, const GeometryRecord& record, std::span<const PlacementStep> path,
                  float time) {
    Transform toRender;
    for (std::size_t i = path.size(); i-- > 0;) toRender = toRender.then(path[i].placement(time).map());
    RTCGeometry geometry = rtcGetGeometry(scene, h.geomID);
    const auto verticesOf = [&](unsigned step) {
        return static_cast<const Vec3*>(rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_VERTEX, step));
    };
    const StepPosition at = record.steps > 1 ? stepAt(time, record.steps) : StepPosition{};
    const Vec3* const vertices = verticesOf(at.step);
    const Vec3* const next = record.steps > 1 ? verticesOf(at.step + 1) : vertices;
    const auto* indices =
        static_cast<const std::uint32_t*>(rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_INDEX, 0));
    const std::size_t corners = record.kind == PrimitiveKind::quads ? 4 : 3;
    const auto vertex = [&](std::size_t i) {
        const std::uint32_t v = indices[corners * h.primID + i];
        const Vec3d p(record.steps > 1 ? between(vertices[v], next[v], at.fraction) : vertices[v]);
        return path.empty() ? p : toRender.point(p);
    };
    if (corners == 3) return {{{{vertex(0), vertex(1), vertex(2)}}}, 1};
    return {{{{vertex(0), vertex(1), vertex(3)}, {vertex(2), vertex(3), vertex(1)}}}, 2};
}

} // namespace

const GeometryRecord& EmbreeScene::recordOf(const RTCHit& h, Path path) const {
    return records[h.geomID + (path.empty() ? 0 : path.back().table->firstRecord())];
}

void EmbreeScene::surface(const RTCHit& h, Path path, float distance, const Ray& ray, SurfaceHit& hit) const {
    const GeometryRecord& record = recordOf(h, path);
    const RawHit raw{h.u, h.v, distance, h.primID, record.part};
    hit.material = record.material;
    hit.light = record.light;
    hit.shape = record.shape;
    if (path.empty()) [[likely]] {
        hit.instance = SurfaceHit::kNoInstance;
        record.shape->surface(raw, ray, hit);
        if (record.space != GeometryRecord::kUntextured) [[unlikely]]
            parametrize(record, raw, ray, hit);
    } else {
        surfaceInside(record, raw, path, ray, hit);
    }
}

[[gnu::noinline]] void EmbreeScene::parametrize(const GeometryRecord& record, const RawHit& raw, const Ray& ray,
                                                SurfaceHit& hit) const {
    hit.shape = record.shape;
    hit.part = raw.part;
    hit.element = raw.primitive;
    hit.barycentric = {raw.u, raw.v};
    hit.dpdu = hit.dpdv = {};
    hit.local = hit.p;
    record.shape->parametrize(raw, ray, hit);
    ownSpaces[record.space].complete(hit);
}

void EmbreeScene::surfaceInside(const GeometryRecord& record, const RawHit& raw, Path path, const Ray& ray,
                                SurfaceHit& hit) const {
    Ray inside = ray;
    for (const PlacementStep& step : path) inside = step.placement(ray.time).toObject(inside);
    record.shape->surface(raw, inside, hit);
    const bool textured = record.space != GeometryRecord::kUntextured;
    if (textured) parametrize(record, raw, inside, hit);
    for (std::size_t i = path.size(); i-- > 0;) {
        const Instance instance(path[i].placement(ray.time));
        instance.toRender(hit);
        if (textured) instance.parametrizationToRender(hit);
    }
    hit.instance = static_cast<std::uint32_t>(path[0].table->firstInstance() + path[0].index);
}

bool EmbreeScene::intersect(const Ray& ray, SurfaceHit& hit) const noexcept {
    if (!isTraceable(ray)) [[unlikely]] {
        rejected_.fetch_add(1, std::memory_order_relaxed);
        return false;
    }
    RTCRayHit rayHit;
    fill(rayHit.ray, ray, kNearestHit);
    RayContext context(rejected_);
    cast(scene.get(), context, rayHit);
    if (rayHit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
    surface(rayHit.hit, context.path(rayHit.hit), rayHit.ray.tfar, ray, hit);
    // On triangles met edge-on Embree reports hits that are not there, and misplaces others; the point from the
    // barycentrics then lies off the ray (docs/hard_cases.md, case 4).
    const Deviation off = deviation(ray, hit);
    const float tolerance = 16 * maxComponent(hit.pError) + 1e-6f * off.along;
    const bool near = off.offLine2 <= tolerance * tolerance;
    const bool same = std::abs(off.along - rayHit.ray.tfar) <= 1e-3f * off.along + tolerance;
    if (!(near && same && off.along > 0)) [[unlikely]]
        return resolve(rayHit, context, ray, hit);
    hit.distance = off.along;
    if (moving) [[unlikely]]
        countMotion(rayHit.hit, context.path(rayHit.hit));
    return true;
}

[[gnu::noinline]] void EmbreeScene::countMotion(const RTCHit& hit, Path path) const {
    const auto moves = [](const PlacementStep& step) { return step.table->moves(); };
    if (recordOf(hit, path).steps > 1 || std::ranges::any_of(path, moves)) ++workState.movingHits;
}

// Decides about a suspicious hit, and about those behind it if it is none, in double.
[[gnu::noinline]] bool EmbreeScene::resolve(RTCRayHit& rayHit, RayContext& context, const Ray& ray,
                                            SurfaceHit& hit) const {
    bool found = false;
    RTCHit nearest{};
    std::array<PlacementStep, kMaxInstanceLevels> path;
    float distance = ray.tMax;
    for (int i = 0; i < kMaxRecasts && rayHit.hit.geomID != RTC_INVALID_GEOMETRY_ID; ++i) {
        const float reported = rayHit.ray.tfar;
        // A hit that truly lies farther than Embree said stands once nothing nearer is left.
        if (found && distance <= reported) break;
        float t = reported;
        if (recompute(rayHit.hit, context.path(rayHit.hit), ray, t) && t <= distance) {
            nearest = rayHit.hit;
            std::ranges::copy(context.path(nearest), path.begin());
            distance = t;
            found = true;
        }
        fill(rayHit.ray, ray, std::nextafter(reported, kInfinity));
        if (!(rayHit.ray.tnear < rayHit.ray.tfar)) break;
        cast(scene.get(), context, rayHit);
    }
    if (!found) return false;
    const Path way{path.data(), nearest.instID[0]};
    surface(nearest, way, distance, ray, hit);
    hit.distance = distance;
    if (moving) countMotion(nearest, way);
    return true;
}

// The true barycentrics and distance of a hit [Moller1997]; false if the ray misses the primitive. Rays that pass an
// edge within rounding count as hits, so that neighbours leave no crack.
bool EmbreeScene::recompute(RTCHit& h, Path path, const Ray& ray, float& distance) const {
    constexpr double slack = 1e-6;
    const GeometryRecord& record = recordOf(h, path);
    const PrimitiveKind kind = record.kind;
    if (kind != PrimitiveKind::triangles && kind != PrimitiveKind::quads) return true; // computed in double already
    const Corners corners =
        cornersOf(path.empty() ? scene.get() : path.back().table->object(), h, record, path, ray.time);
    const Vec3d o(ray.origin), d(ray.direction);
    double best = std::numeric_limits<double>::infinity();
    for (int i = 0; i < corners.count; ++i) {
        const auto& [a, b, c] = corners.triangle[static_cast<std::size_t>(i)];
        const Vec3d e1 = b - a, e2 = c - a, s = o - a;
        const Vec3d p = cross(d, e2), q = cross(s, e1);
        const double inverse = 1 / dot(e1, p); // infinite for rays in the plane: all tests below fail
        const double u = dot(s, p) * inverse, v = dot(d, q) * inverse, t = dot(e2, q) * inverse;
        if (!(u >= -slack && v >= -slack && u + v <= 1 + slack && t > 0 && t < best)) continue;
        best = t;
        h.u = static_cast<float>(i == 0 ? u : 1 - u);
        h.v = static_cast<float>(i == 0 ? v : 1 - v);
    }
    distance = static_cast<float>(best);
    return std::isfinite(best) && best <= static_cast<double>(ray.tMax);
}

// Met again, because hits do not keep the way to their object: of this shape, nothing else lies so near to the point.
std::optional<Passage> EmbreeScene::passage(const Ray& ray, const SurfaceHit& hit, float distance) const noexcept {
    const float cosine = std::max(std::abs(dot(ray.direction, hit.ng)), 0.01f);
    const float rounding = (4 * dot(abs(hit.ng), hit.pError) + 0x1p-20f * distance) / cosine;
    Ray window = ray;
    window.tMax = distance + rounding;
    RayContext context(rejected_);
    float near = std::max(distance - rounding, kNearestHit);
    for (int i = 0; i < kMaxRecasts && near < window.tMax; ++i) {
        RTCRayHit rayHit;
        fill(rayHit.ray, window, near);
        cast(scene.get(), context, rayHit);
        if (rayHit.hit.geomID == RTC_INVALID_GEOMETRY_ID) break;
        const Path path = context.path(rayHit.hit);
        if (recordOf(rayHit.hit, path).shape == hit.shape) return passage(rayHit.hit, path, rayHit.ray.tfar, ray, hit);
        near = std::nextafter(rayHit.ray.tfar, kInfinity);
    }
    return std::nullopt;
}

Passage EmbreeScene::passage(const RTCHit& h, Path path, float distance, const Ray& ray, const SurfaceHit& hit) const {
    const GeometryRecord& record = recordOf(h, path);
    if (path.empty() && record.steps == 1) return {hit.p, hit.p};
    const RawHit raw{h.u, h.v, distance, h.primID, record.part};
    Ray inside = ray;
    for (const PlacementStep& step : path) inside = step.placement(ray.time).toObject(inside);
    SurfaceHit own;
    record.shape->surface(raw, inside, own);
    const auto at = [&](float time) {
        Vec3d p(record.shape->carried(raw, inside, own, time));
        for (std::size_t i = path.size(); i-- > 0;) p = path[i].placement(time).map().point(p);
        return Vec3(p);
    };
    return {at(0), at(1)};
}

// Within the offset of the origins of rays that go on, on both sides, or a film of air that light crosses as if it were
// not there (docs/decisions/016-nested-dielectrics.md).
std::size_t EmbreeScene::coincident(const Ray& ray, const SurfaceHit& hit,
                                    std::span<SurfaceHit> others) const noexcept {
    const float cosine = std::max(std::abs(dot(ray.direction, hit.ng)), 0.01f);
    constexpr float kOpticalContact = 5e-8f; // m
    const float rounding = (4 * dot(abs(hit.ng), hit.pError) + kOpticalContact) / cosine + 0x1p-21f * hit.distance;
    Ray window = ray;
    window.tMax = hit.distance + rounding;
    RayContext context(rejected_);
    context.skipped[context.skippedCount++] = hit.shape;
    std::size_t count = 0;
    while (count < others.size()) {
        RTCRayHit rayHit;
        fill(rayHit.ray, window, std::max(hit.distance - rounding, kNearestHit));
        cast(scene.get(), context, rayHit);
        if (rayHit.hit.geomID == RTC_INVALID_GEOMETRY_ID) break;
        SurfaceHit& other = others[count];
        surface(rayHit.hit, context.path(rayHit.hit), rayHit.ray.tfar, ray, other);
        other.distance = rayHit.ray.tfar;
        context.skipped[context.skippedCount++] = other.shape;
        // Only those of the same layer of other dielectrics: an opaque surface ends the path when it is met.
        if (other.material->ior()) ++count;
        if (context.skippedCount == RayContext::kMaxSkipped) break;
    }
    return count;
}

bool EmbreeScene::occluded(const Ray& ray) const noexcept {
    if (!isTraceable(ray)) [[unlikely]] {
        rejected_.fetch_add(1, std::memory_order_relaxed);
        return false;
    }
    RayContext context(rejected_);
    RTCRay r;
    fill(r, ray, kNearestHit);
    const WorkScope work(Work::tracing);
    rtcOccluded1(scene.get(), &context.rtc, &r);
    return r.tfar < 0;
}

} // namespace abbe
