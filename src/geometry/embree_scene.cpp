#include "geometry/embree_scene.h"

#include "base/parallel.h"
#include "base/work.h"
#include "geometry/instance_table.h"
#include "geometry/surface_math.h"
#include "render/material.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <new>
#include <stdexcept>

namespace abbe {

namespace {

void remember(void* user, RTCError code, const char* text) {
    auto& first = *static_cast<EmbreeDevice::Fault*>(user);
    if (first.code == RTC_ERROR_NONE) first = {code, text ? text : "no text"};
}

#ifdef __SANITIZE_THREAD__
// Embree builds in TBB's threads, whose order the thread sanitizer does not see (base/parallel.cpp).
int buildThreads() { return 1; }
#else
// 0: as many as loops have (base/parallel.h). A number would hold for all loops from then on, of cores at most.
int buildThreads() { return 0; }
#endif

} // namespace

EmbreeDevice::EmbreeDevice()
    : firstError_(std::make_unique<Fault>()), device_(rtcNewDevice(fmt::format("threads={}", buildThreads()).c_str())) {
    if (!device_) {
        const RTCError error = rtcGetDeviceError(nullptr);
        if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
        throw std::runtime_error(
            fmt::format("Embree cannot start on this machine (error {})", static_cast<int>(error)));
    }
    rtcSetDeviceErrorFunction(device_.get(), remember, firstError_.get());
}

void EmbreeDevice::throwIfFailed() const {
    if (firstError_->code == RTC_ERROR_NONE) return;
    if (firstError_->code == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
    throw std::runtime_error(
        fmt::format("Embree error {}: {}", static_cast<int>(firstError_->code), firstError_->text));
}

namespace {

// Callbacks of shapes that intersect themselves. The geometry's user pointer is the shape.
const Shape& shapeOf(void* user) { return *static_cast<const Shape*>(user); }

const RayContext& contextOf(const RTCIntersectContext* context) {
    return *reinterpret_cast<const RayContext*>(context);
}

// Filters the hits of meshes.
void skipMesh(const RTCFilterFunctionNArguments* args) {
    if (args->N != 1 || args->valid[0] == 0) return;
    if (contextOf(args->context).skips(&shapeOf(args->geometryUserPtr))) args->valid[0] = 0;
}

void analyticBounds(const RTCBoundsFunctionArguments* args) {
    const Bounds3 b = shapeOf(args->geometryUserPtr).bounds();
    *args->bounds_o = {b.lower.x, b.lower.y, b.lower.z, 0, b.upper.x, b.upper.y, b.upper.z, 0};
}

std::optional<RawHit> analyticHit(const Shape& shape, const RTCRay& r) {
    const Vec3 direction(r.dir_x, r.dir_y, r.dir_z);
    // Shapes know no near end: a ray cast again past a false hit starts there.
    const Vec3 origin = Vec3(r.org_x, r.org_y, r.org_z) + (r.tnear > kNearestHit ? direction * r.tnear : Vec3());
    auto hit = shape.intersect({origin, direction, r.tfar - r.tnear});
    if (hit) hit->distance += r.tnear;
    return hit;
}

void analyticIntersect(const RTCIntersectFunctionNArguments* args) {
    auto& rayHit = *reinterpret_cast<RTCRayHit*>(args->rayhit);
    if (args->N != 1 || args->valid[0] == 0) return;
    const Shape& shape = shapeOf(args->geometryUserPtr);
    if (contextOf(args->context).skips(&shape)) return;
    const auto hit = analyticHit(shape, rayHit.ray);
    if (!hit) return;
    rayHit.ray.tfar = hit->distance;
    rayHit.hit.u = hit->u; // the shape's own words
    rayHit.hit.v = hit->v;
    rayHit.hit.primID = args->primID;
    rayHit.hit.geomID = args->geomID;
    rayHit.hit.instID[0] = args->context->instID[0];
}

void analyticOccluded(const RTCOccludedFunctionNArguments* args) {
    auto& ray = *reinterpret_cast<RTCRay*>(args->ray);
    if (args->N != 1 || args->valid[0] == 0) return;
    if (analyticHit(shapeOf(args->geometryUserPtr), ray)) ray.tfar = -kInfinity;
}

} // namespace

void attachGeometry(RTCScene scene, RTCGeometry geometry, std::size_t id, Visibility visible) {
    rtcSetGeometryMask(geometry, visible.bits());
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, static_cast<unsigned>(id));
    rtcReleaseGeometry(geometry);
}

EmbreeSink::EmbreeSink(RTCDevice device, RTCScene scene, std::vector<GeometrySlot>& slots)
    : device_(device), scene_(scene), slots_(slots), first_(slots.size()) {}

void EmbreeSink::add(const ShapeUse& use) {
    use_ = use;
    next_ = {};
    use.shape->commit(*this);
}

// A buffer per time step; Embree refuses other numbers of them than the geometry has.
template <typename T>
void EmbreeSink::shareSteps(RTCGeometry geometry, RTCBufferType type, RTCFormat format, TimeSteps<T> steps) {
    next_.steps = static_cast<std::uint8_t>(steps.size());
    if (steps.size() > 1) rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(steps.size()));
    for (std::size_t i = 0; i < steps.size(); ++i)
        rtcSetSharedGeometryBuffer(geometry, type, static_cast<unsigned>(i), format, steps[i].data(), 0, sizeof(T),
                                   steps[i].size());
}

void EmbreeSink::triangles(TimeSteps<Vec3> vertices, Triangles indices) {
    mesh(RTC_GEOMETRY_TYPE_TRIANGLE, RTC_FORMAT_UINT3, vertices, indices.data(), sizeof(indices[0]), indices.size());
}

void EmbreeSink::quads(TimeSteps<Vec3> vertices, Quads indices) {
    mesh(RTC_GEOMETRY_TYPE_QUAD, RTC_FORMAT_UINT4, vertices, indices.data(), sizeof(indices[0]), indices.size());
}

void EmbreeSink::mesh(RTCGeometryType type, RTCFormat format, TimeSteps<Vec3> vertices, const void* indices,
                      std::size_t stride, std::size_t count) {
    RTCGeometry geometry = rtcNewGeometry(device_, type);
    shareSteps(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, vertices);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, format, indices, 0, stride, count);
    if (use_.skippable) {
        rtcSetGeometryUserData(geometry, const_cast<Shape*>(use_.shape)); // read back as const
        rtcSetGeometryIntersectFilterFunction(geometry, skipMesh);
    }
    attach(geometry, type == RTC_GEOMETRY_TYPE_QUAD ? PrimitiveKind::quads : PrimitiveKind::triangles);
}

namespace {

void confirmHit(const RTCFilterFunctionNArguments* args) {
    if (args->N != 1 || args->valid[0] == 0) return;
    const auto& r = *reinterpret_cast<const RTCRay*>(args->ray);
    const auto& h = *reinterpret_cast<const RTCHit*>(args->hit);
    const Ray ray{Vec3(r.org_x, r.org_y, r.org_z), Vec3(r.dir_x, r.dir_y, r.dir_z), kInfinity, r.time};
    const RawHit hit{.u = h.u, .v = h.v, .distance = r.tfar, .primitive = h.primID};
    if (!shapeOf(args->geometryUserPtr).confirms(hit, ray)) args->valid[0] = 0;
}

RTCGeometryType curveType(CurveBasis basis, CurveForm form) {
    const bool round = form == CurveForm::round;
    switch (basis) {
    case CurveBasis::linear:
        return round ? RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE : RTC_GEOMETRY_TYPE_FLAT_LINEAR_CURVE;
    case CurveBasis::bspline:
        return round ? RTC_GEOMETRY_TYPE_ROUND_BSPLINE_CURVE : RTC_GEOMETRY_TYPE_FLAT_BSPLINE_CURVE;
    case CurveBasis::catmullRom:
        return round ? RTC_GEOMETRY_TYPE_ROUND_CATMULL_ROM_CURVE : RTC_GEOMETRY_TYPE_FLAT_CATMULL_ROM_CURVE;
    case CurveBasis::bezier:
        break;
    }
    return round ? RTC_GEOMETRY_TYPE_ROUND_BEZIER_CURVE : RTC_GEOMETRY_TYPE_FLAT_BEZIER_CURVE;
}

static_assert(sizeof(SizedPoint) == 4 * sizeof(float));
static_assert(int(kPreviousSegment) == int(RTC_CURVE_FLAG_NEIGHBOR_LEFT));
static_assert(int(kNextSegment) == int(RTC_CURVE_FLAG_NEIGHBOR_RIGHT));

} // namespace

void EmbreeSink::curves(CurveBasis basis, CurveForm form, TimeSteps<SizedPoint> points,
                        std::span<const std::uint32_t> firstPoints, std::span<const std::uint8_t> neighbours) {
    RTCGeometry geometry = rtcNewGeometry(device_, curveType(basis, form));
    shareSteps(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, points);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, firstPoints.data(), 0,
                               sizeof(std::uint32_t), firstPoints.size());
    if (!neighbours.empty())
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_FLAGS, 0, RTC_FORMAT_UCHAR, neighbours.data(), 0, 1,
                                   neighbours.size());
    if (basis == CurveBasis::linear && form == CurveForm::round) {
        rtcSetGeometryUserData(geometry, const_cast<Shape*>(use_.shape)); // read back as const
        rtcSetGeometryIntersectFilterFunction(geometry, confirmHit);
        rtcSetGeometryOccludedFilterFunction(geometry, confirmHit);
    }
    attach(geometry, PrimitiveKind::curves);
}

void EmbreeSink::points(PointForm form, TimeSteps<SizedPoint> points, TimeSteps<Vec3> normals) {
    RTCGeometry geometry = rtcNewGeometry(device_, form == PointForm::sphere ? RTC_GEOMETRY_TYPE_SPHERE_POINT
                                                   : form == PointForm::disk ? RTC_GEOMETRY_TYPE_DISC_POINT
                                                                             : RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT);
    shareSteps(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, points);
    if (!normals.empty()) shareSteps(geometry, RTC_BUFFER_TYPE_NORMAL, RTC_FORMAT_FLOAT3, normals);
    attach(geometry, PrimitiveKind::points);
}

void EmbreeSink::analytic(const Bounds3&) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, 1);
    rtcSetGeometryUserData(geometry, const_cast<Shape*>(use_.shape)); // read back as const
    rtcSetGeometryBoundsFunction(geometry, analyticBounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, analyticIntersect);
    rtcSetGeometryOccludedFunction(geometry, analyticOccluded);
    attach(geometry, PrimitiveKind::analytic);
}

void EmbreeSink::attach(RTCGeometry geometry, PrimitiveKind kind) {
    attachGeometry(scene_, geometry, slots_.size() - first_, use_.visible);
    next_.kind = kind;
    slots_.push_back(next_);
    ++next_.part;
}

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

// Fills the hit and its distance.
[[gnu::always_inline]] inline bool EmbreeScene::nearest(const Ray& ray, RayContext& context, RTCRayHit& rayHit) const {
    if (!few) {
        fill(rayHit.ray, ray, kNearestHit);
        cast(scene, context, rayHit);
        return rayHit.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }
    const WorkScope work(Work::tracing);
    const auto found = few->intersect(ray);
    if (!found) return false;
    rayHit.ray.tfar = found->t;
    rayHit.hit.u = found->u;
    rayHit.hit.v = found->v;
    rayHit.hit.geomID = found->record;
    rayHit.hit.primID = found->primitive;
    rayHit.hit.instID[0] = 0;
    return true;
}

bool EmbreeScene::intersect(const Ray& ray, SurfaceHit& hit) const noexcept {
    if (!isTraceable(ray)) [[unlikely]] {
        rejected_.fetch_add(1, std::memory_order_relaxed);
        return false;
    }
    RTCRayHit rayHit;
    RayContext context(rejected_);
    if (!nearest(ray, context, rayHit)) return false;
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
        cast(scene, context, rayHit);
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
    const Corners corners = cornersOf(path.empty() ? scene : path.back().table->object(), h, record, path, ray.time);
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

// Hit again, because hits do not keep the way to their object: of this shape, nothing else lies so near to the point.
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
        cast(scene, context, rayHit);
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
    context.skipped[context.skippedCount++] = hit.shape ? &hit.shape->primitives() : nullptr;
    std::size_t count = 0;
    while (count < others.size()) {
        RTCRayHit rayHit;
        fill(rayHit.ray, window, std::max(hit.distance - rounding, kNearestHit));
        cast(scene, context, rayHit);
        if (rayHit.hit.geomID == RTC_INVALID_GEOMETRY_ID) break;
        SurfaceHit& other = others[count];
        surface(rayHit.hit, context.path(rayHit.hit), rayHit.ray.tfar, ray, other);
        other.distance = rayHit.ray.tfar;
        context.skipped[context.skippedCount++] = &other.shape->primitives();
        // Only those of the same layer of other dielectrics: an opaque surface ends the path when it is hit.
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
    const WorkScope work(Work::tracing);
    if (few) return few->occluded(ray);
    RayContext context(rejected_);
    RTCRay r;
    fill(r, ray, kNearestHit);
    rtcOccluded1(scene, &context.rtc, &r);
    return r.tfar < 0;
}

} // namespace abbe
