#include "geometry/embree_scene.h"

#include "base/check.h"
#include "base/parallel.h"
#include "base/work.h"
#include "geometry/embree_device.h"
#include "geometry/embree_sink.h"
#include "geometry/instance_table.h"
#include "geometry/surface_math.h"
#include "geometry/time_steps.h"
#include "render/material.h"
#include "render/own_space.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <embree3/rtcore.h>
#include <map>

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
    r.mask = 0xffffffffu;
    r.id = 0;
    r.flags = 0;
}

// Where a segment ends for occlusion: the surface that its end point belongs to is met at 1 give or take the rounding
// of Embree's distance, a few ulp.
constexpr float kBeforeEnd = 1 - 0x1p-20f;

class EmbreeScene final : public Intersector {
  public:
    bool intersect(const Ray&, SurfaceHit&) const noexcept override;
    bool occluded(const Ray&) const noexcept override;
    bool occluded(Vec3 from, Vec3 to, float time) const noexcept override {
        return occluded({from, to - from, kBeforeEnd, time});
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

[[gnu::always_inline]] inline void cast(RTCScene scene, RayContext& context, RTCRayHit& rayHit) {
    const WorkScope work(Work::tracing);
    rayHit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &context.rtc, &rayHit);
}

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

// How far the hit point is from the ray's line, squared, and where along the ray it is.
struct Deviation {
    float along, offLine2;
};
Deviation deviation(const Ray& ray, const SurfaceHit& hit) {
    const Vec3 e = hit.p - ray.origin;
    const float along = dot(e, ray.direction);
    return {along, lengthSquared(e - ray.direction * along)};
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

} // namespace

struct EmbreeSceneBuilder::Impl {
    using Shapes = std::vector<std::pair<const Shape*, Binding>>;
    using Inside = std::pair<std::uint32_t, std::uint32_t>; // what holds placements, and the object placed
    Shapes shapes;
    std::vector<Shapes> objects;
    std::map<Inside, std::vector<Placement>> placements;
    std::map<Inside, std::vector<Motion>> moving;
    Interval shutter;
    bool nested = false;

    // What is known of an object's scene once it is built.
    struct BuiltObject {
        RTCScene scene = nullptr;
        std::size_t firstRecord = 0;
        Bounds3 bounds;
        int levels = 0; // of objects inside of it
    };
    std::vector<BuiltObject> built;
    std::uint64_t instanceCount = 0;

    static EmbreeHandle<RTCScene, rtcReleaseScene> newScene(const EmbreeScene&);
    void addShapes(EmbreeScene&, const Shapes&, BuiltObject&) const;
    void addTables(EmbreeScene&, std::uint32_t inside, std::size_t geometryId, BuiltObject&);
    void addMoving(EmbreeScene&, std::uint32_t inside, std::size_t geometryId, BuiltObject&);
    static const InstanceTable& addTable(EmbreeScene&, std::size_t geometryId, const BuiltObject& placed,
                                         BuiltObject& inside, std::unique_ptr<const InstanceTable>);
};

EmbreeHandle<RTCScene, rtcReleaseScene> EmbreeSceneBuilder::Impl::newScene(const EmbreeScene& target) {
    EmbreeHandle<RTCScene, rtcReleaseScene> scene(rtcNewScene(target.device.get()));
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);
    return scene;
}

// Adds the shapes to the scene, their records to the target, and the bounds of the finite ones.
void EmbreeSceneBuilder::Impl::addShapes(EmbreeScene& target, const Shapes& added, BuiltObject& object) const {
    object.firstRecord = target.records.size();
    EmbreeSink sink(target.device.get(), object.scene, target.records, nested);
    for (const auto& [shape, binding] : added) {
        std::uint32_t space = GeometryRecord::kUntextured;
        if (binding.parametrized || shape->usesTextures() || (binding.material && binding.material->usesTextures())) {
            space = static_cast<std::uint32_t>(target.ownSpaces.size());
            target.ownSpaces.emplace_back(binding.toOwn.value_or(Transform{}));
        }
        sink.add(*shape, binding.material, binding.light, space);
        if (std::isfinite(shape->area())) object.bounds.add(shape->bounds());
    }
}

// Adds what is placed inside, with geometry ids from the given one on, which no record needs: hits name what they met
// in the innermost object.
void EmbreeSceneBuilder::Impl::addTables(EmbreeScene& target, std::uint32_t inside, std::size_t geometryId,
                                         BuiltObject& object) {
    for (auto list = placements.lower_bound({inside, 0}); list != placements.end() && list->first.first == inside;
         ++list) {
        const BuiltObject& placed = built[list->first.second];
        const auto& table = addTable(target, geometryId++, placed, object,
                                     std::make_unique<const InstanceTable>(placed.scene, std::move(list->second),
                                                                           placed.firstRecord, instanceCount));
        if (inside == kScene) instanceCount += table.size();
    }
    addMoving(target, inside, geometryId, object);
    ABBE_CHECK(object.levels <= kMaxInstanceLevels);
}

void EmbreeSceneBuilder::Impl::addMoving(EmbreeScene& target, std::uint32_t inside, std::size_t geometryId,
                                         BuiltObject& object) {
    for (auto list = moving.lower_bound({inside, 0}); list != moving.end() && list->first.first == inside; ++list) {
        const BuiltObject& placed = built[list->first.second];
        const auto& table = addTable(target, geometryId++, placed, object,
                                     std::make_unique<const InstanceTable>(placed.scene, std::move(list->second),
                                                                           shutter, placed.firstRecord, instanceCount));
        if (inside == kScene) instanceCount += table.size();
    }
}

const InstanceTable& EmbreeSceneBuilder::Impl::addTable(EmbreeScene& target, std::size_t geometryId,
                                                        const BuiltObject& placed, BuiltObject& inside,
                                                        std::unique_ptr<const InstanceTable> table) {
    table->attach(target.device.get(), inside.scene, geometryId);
    inside.bounds.add(table->bounds(placed.bounds));
    inside.levels = std::max(inside.levels, placed.levels + 1);
    return *target.tables.emplace_back(std::move(table));
}

EmbreeSceneBuilder::EmbreeSceneBuilder() : impl_(std::make_unique<Impl>()) {}
EmbreeSceneBuilder::~EmbreeSceneBuilder() = default;

std::uint32_t EmbreeSceneBuilder::addShape(const Shape& shape, Binding binding) {
    impl_->shapes.emplace_back(&shape, binding);
    return static_cast<std::uint32_t>(impl_->shapes.size() - 1);
}

std::uint32_t EmbreeSceneBuilder::addObject(std::vector<std::pair<const Shape*, Binding>> shapes) {
    impl_->objects.push_back(std::move(shapes));
    return static_cast<std::uint32_t>(impl_->objects.size() - 1);
}

void EmbreeSceneBuilder::addInstance(std::uint32_t object, const Transform& map, std::uint32_t inside) {
    ABBE_CHECK(object < impl_->objects.size() &&
               (inside == kScene || (inside > object && inside < impl_->objects.size())));
    impl_->placements[{inside, object}].emplace_back(map);
}

void EmbreeSceneBuilder::addInstances(std::uint32_t object, std::vector<Placement> placements, std::uint32_t inside) {
    ABBE_CHECK(object < impl_->objects.size() &&
               (inside == kScene || (inside > object && inside < impl_->objects.size())));
    if (placements.empty()) return;
    auto& list = impl_->placements[{inside, object}];
    if (list.empty())
        list = std::move(placements);
    else
        list.insert(list.end(), placements.begin(), placements.end());
}

void EmbreeSceneBuilder::setShutter(double open, double duration) { impl_->shutter = {open, duration}; }
Interval EmbreeSceneBuilder::shutter() const { return impl_->shutter; }
void EmbreeSceneBuilder::setNested(bool nested) { impl_->nested = nested; }

void EmbreeSceneBuilder::addMoving(std::uint32_t object, const Motion& motion, std::uint32_t inside) {
    ABBE_CHECK(object < impl_->objects.size() &&
               (inside == kScene || (inside > object && inside < impl_->objects.size())));
    impl_->moving[{inside, object}].push_back(motion);
}

std::unique_ptr<Intersector> EmbreeSceneBuilder::build() {
    auto result = std::make_unique<EmbreeScene>();
    EmbreeScene& s = *result;
    s.scene = Impl::newScene(s);
    Impl::BuiltObject top;
    top.scene = s.scene.get();
    impl_->addShapes(s, impl_->shapes, top); // first: its records stand at its geometry ids
    const std::size_t firstTable = s.records.size();
    for (std::uint32_t i = 0; i < impl_->objects.size(); ++i) {
        Impl::BuiltObject object;
        object.scene = s.objectScenes.emplace_back(Impl::newScene(s)).get();
        impl_->addShapes(s, impl_->objects[i], object);
        impl_->addTables(s, i, s.records.size() - object.firstRecord, object);
        rtcCommitScene(object.scene);
        impl_->built.push_back(object);
    }
    impl_->addTables(s, kScene, firstTable, top);
    s.bounds_ = top.bounds;
    s.moving = std::ranges::any_of(s.records, [](const GeometryRecord& r) { return r.steps > 1; }) ||
               std::ranges::any_of(s.tables, [](const auto& table) { return table->moves(); });
    rtcCommitScene(s.scene.get());
    s.device.throwIfFailed();
    return result;
}

} // namespace abbe
