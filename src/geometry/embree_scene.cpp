#include "geometry/embree_scene.h"

#include "base/check.h"
#include "base/parallel.h"
#include "geometry/embree_device.h"
#include "geometry/embree_sink.h"
#include "geometry/instance.h"
#include "geometry/surface_math.h"

#include <array>
#include <atomic>
#include <embree3/rtcore.h>

namespace abbe {

namespace {

// Coordinates beyond this make Debian's Embree stop the process.
constexpr float kLargestCoordinate = 1e18f;
// False hits dropped on one ray before it is given up as a miss.
constexpr int kMaxRecasts = 32;

// An instance with its object: its scene, and where its records begin.
struct PlacedObject {
    Instance instance;
    RTCScene scene;
    std::size_t firstRecord;
};

// NaN fails every comparison.
[[gnu::always_inline]] inline bool traceable(const Ray& ray) {
    const Vec3 o = abs(ray.origin), d = abs(ray.direction);
    return o.x + o.y + o.z < kLargestCoordinate && d.x + d.y + d.z < kLargestCoordinate && ray.tMax >= 0;
}

void fill(RTCRay& r, const Ray& ray, float tNear) {
    r.org_x = ray.origin.x;
    r.org_y = ray.origin.y;
    r.org_z = ray.origin.z;
    r.tnear = tNear;
    r.dir_x = ray.direction.x;
    r.dir_y = ray.direction.y;
    r.dir_z = ray.direction.z;
    r.time = 0;
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
    bool occluded(Vec3 from, Vec3 to) const noexcept override { return occluded({from, to - from, kBeforeEnd, 0}); }
    Bounds3 bounds() const override { return bounds_; }
    std::uint64_t rejectedRays() const override { return rejected_.load(std::memory_order_relaxed); }

    EmbreeDevice device;
    std::vector<EmbreeHandle<RTCScene, rtcReleaseScene>> objectScenes;
    EmbreeHandle<RTCScene, rtcReleaseScene> scene;
    std::vector<GeometryRecord> records; // of the top scene by geometry id, then of each object
    std::vector<PlacedObject> placed;
    Bounds3 bounds_;

  private:
    const PlacedObject* placeOf(const RTCHit&) const;
    const GeometryRecord& recordOf(const RTCHit&, const PlacedObject*) const;
    void surface(const RTCHit&, float distance, const Ray&, SurfaceHit&) const;
    bool resolve(RTCRayHit&, const Ray&, SurfaceHit&) const;
    bool recompute(RTCHit&, const Ray&, float& distance) const;

    mutable std::atomic<std::uint64_t> rejected_{0};
};

void cast(RTCScene scene, RTCRayHit& rayHit) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rayHit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rayHit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &context, &rayHit);
}

const PlacedObject* EmbreeScene::placeOf(const RTCHit& h) const {
    return h.instID[0] == RTC_INVALID_GEOMETRY_ID ? nullptr : &placed[records[h.instID[0]].part];
}

const GeometryRecord& EmbreeScene::recordOf(const RTCHit& h, const PlacedObject* place) const {
    return records[h.geomID + (place ? place->firstRecord : 0)];
}

void EmbreeScene::surface(const RTCHit& h, float distance, const Ray& ray, SurfaceHit& hit) const {
    const PlacedObject* place = placeOf(h);
    const GeometryRecord& record = recordOf(h, place);
    const RawHit raw{h.u, h.v, distance, h.primID, record.part};
    hit.material = record.material;
    hit.light = record.light;
    if (place) [[unlikely]] {
        record.shape->surface(raw, place->instance.toObject(ray), hit);
        place->instance.toRender(hit);
    } else {
        record.shape->surface(raw, ray, hit);
    }
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
    if (!traceable(ray)) [[unlikely]] {
        rejected_.fetch_add(1, std::memory_order_relaxed);
        return false;
    }
    RTCRayHit rayHit;
    fill(rayHit.ray, ray, kNearestHit);
    cast(scene.get(), rayHit);
    if (rayHit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
    surface(rayHit.hit, rayHit.ray.tfar, ray, hit);
    // On triangles met edge-on Embree reports hits that are not there, and misplaces others; the point from the
    // barycentrics then lies off the ray (docs/hard_cases.md, case 4).
    const Deviation off = deviation(ray, hit);
    const float tolerance = 16 * maxComponent(hit.pError) + 1e-6f * off.along;
    const bool near = off.offLine2 <= tolerance * tolerance;
    const bool same = std::abs(off.along - rayHit.ray.tfar) <= 1e-3f * off.along + tolerance;
    if (!(near && same && off.along > 0)) [[unlikely]]
        return resolve(rayHit, ray, hit);
    hit.distance = off.along;
    return true;
}

// Decides about a suspicious hit, and about those behind it if it is none, in double.
[[gnu::noinline]] bool EmbreeScene::resolve(RTCRayHit& rayHit, const Ray& ray, SurfaceHit& hit) const {
    bool found = false;
    RTCHit nearest;
    float distance = ray.tMax;
    for (int i = 0; i < kMaxRecasts && rayHit.hit.geomID != RTC_INVALID_GEOMETRY_ID; ++i) {
        const float reported = rayHit.ray.tfar;
        // A hit that truly lies farther than Embree said stands once nothing nearer is left.
        if (found && distance <= reported) break;
        float t = reported;
        if (recompute(rayHit.hit, ray, t) && t <= distance) {
            nearest = rayHit.hit;
            distance = t;
            found = true;
        }
        fill(rayHit.ray, ray, std::nextafter(reported, kInfinity));
        if (!(rayHit.ray.tnear < rayHit.ray.tfar)) break;
        cast(scene.get(), rayHit);
    }
    if (!found) return false;
    surface(nearest, distance, ray, hit);
    hit.distance = distance;
    return true;
}

// Corners of the triangles that a primitive consists of, in render space: one, or the two halves of a quad.
struct Corners {
    std::array<std::array<Vec3d, 3>, 2> triangle;
    int count = 0;
};
Corners cornersOf(RTCScene scene, const RTCHit& h, PrimitiveKind kind, const PlacedObject* place) {
    RTCGeometry geometry = rtcGetGeometry(scene, h.geomID);
    const auto* vertices = static_cast<const Vec3*>(rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_VERTEX, 0));
    const auto* indices =
        static_cast<const std::uint32_t*>(rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_INDEX, 0));
    const auto vertex = [&](int i) {
        const std::size_t corners = kind == PrimitiveKind::quads ? 4 : 3;
        const Vec3d p(vertices[indices[corners * h.primID + static_cast<std::size_t>(i)]]);
        return place ? place->instance.map().point(p) : p;
    };
    if (kind == PrimitiveKind::triangles) return {{{{vertex(0), vertex(1), vertex(2)}}}, 1};
    return {{{{vertex(0), vertex(1), vertex(3)}, {vertex(2), vertex(3), vertex(1)}}}, 2};
}

// The true barycentrics and distance of a hit [Moller1997]; false if the ray misses the primitive. Rays that pass an
// edge within rounding count as hits, so that neighbours leave no crack.
bool EmbreeScene::recompute(RTCHit& h, const Ray& ray, float& distance) const {
    constexpr double slack = 1e-6;
    const PlacedObject* place = placeOf(h);
    const PrimitiveKind kind = recordOf(h, place).kind;
    if (kind != PrimitiveKind::triangles && kind != PrimitiveKind::quads) return true; // computed in double already
    const Corners corners = cornersOf(place ? place->scene : scene.get(), h, kind, place);
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

bool EmbreeScene::occluded(const Ray& ray) const noexcept {
    if (!traceable(ray)) [[unlikely]] {
        rejected_.fetch_add(1, std::memory_order_relaxed);
        return false;
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay r;
    fill(r, ray, kNearestHit);
    rtcOccluded1(scene.get(), &context, &r);
    return r.tfar < 0;
}

} // namespace

struct EmbreeSceneBuilder::Impl {
    using Shapes = std::vector<std::pair<const Shape*, Binding>>;
    Shapes shapes;
    std::vector<Shapes> objects;
    std::vector<std::pair<std::uint32_t, Transform>> instances;

    static EmbreeHandle<RTCScene, rtcReleaseScene> newScene(const EmbreeScene&);
    static Bounds3 fill(EmbreeScene&, RTCScene, const Shapes&);
    void place(EmbreeScene&, std::size_t firstId, const std::vector<std::size_t>& firstRecords,
               const std::vector<Bounds3>& objectBounds) const;
};

EmbreeHandle<RTCScene, rtcReleaseScene> EmbreeSceneBuilder::Impl::newScene(const EmbreeScene& target) {
    EmbreeHandle<RTCScene, rtcReleaseScene> scene(rtcNewScene(target.device.get()));
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);
    return scene;
}

// Adds the shapes to the scene, their records to the target. Returns the bounds of the finite ones.
Bounds3 EmbreeSceneBuilder::Impl::fill(EmbreeScene& target, RTCScene scene, const Shapes& shapes) {
    EmbreeSink sink(target.device.get(), scene, target.records);
    Bounds3 bounds;
    for (const auto& [shape, binding] : shapes) {
        sink.add(*shape, binding.material, binding.light);
        if (std::isfinite(shape->area())) bounds.add(shape->bounds());
    }
    return bounds;
}

void EmbreeSceneBuilder::Impl::place(EmbreeScene& s, std::size_t firstId, const std::vector<std::size_t>& firstRecords,
                                     const std::vector<Bounds3>& objectBounds) const {
    s.placed.reserve(instances.size());
    for (const auto& [object, map] : instances) {
        RTCScene scene = s.objectScenes[object].get();
        const Instance& instance = s.placed.emplace_back(Instance(map), scene, firstRecords[object]).instance;
        s.bounds_.add(instance.toRender(objectBounds[object]));
        RTCGeometry geometry = rtcNewGeometry(s.device.get(), RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(geometry, scene);
        rtcSetGeometryTimeStepCount(geometry, 1);
        const auto matrix = instance.rowMajor();
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, matrix.data());
        attachGeometry(s.scene.get(), geometry, firstId + s.placed.size() - 1);
    }
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

void EmbreeSceneBuilder::addInstance(std::uint32_t object, const Transform& objectToRender) {
    ABBE_CHECK(object < impl_->objects.size());
    impl_->instances.emplace_back(object, objectToRender);
}

std::unique_ptr<Intersector> EmbreeSceneBuilder::build() {
    auto result = std::make_unique<EmbreeScene>();
    EmbreeScene& s = *result;
    s.scene = Impl::newScene(s);
    s.bounds_ = Impl::fill(s, s.scene.get(), impl_->shapes);
    // Instances take the next geometry ids of the top scene, so their records come before those of the objects.
    const std::size_t firstInstance = s.records.size();
    for (std::size_t i = 0; i < impl_->instances.size(); ++i)
        s.records.push_back({nullptr, nullptr, nullptr, static_cast<std::uint32_t>(i), PrimitiveKind::instance});

    std::vector<std::size_t> firstRecords;
    std::vector<Bounds3> objectBounds;
    for (const auto& shapes : impl_->objects) {
        firstRecords.push_back(s.records.size());
        const auto& scene = s.objectScenes.emplace_back(Impl::newScene(s));
        objectBounds.push_back(Impl::fill(s, scene.get(), shapes));
        rtcCommitScene(scene.get());
    }
    impl_->place(s, firstInstance, firstRecords, objectBounds);
    rtcCommitScene(s.scene.get());
    s.device.throwIfFailed();
    return result;
}

} // namespace abbe
