// All geometry of a scene behind one intersector, by Embree: ownership of its reference-counted handles and its errors
// as exceptions, shapes as its geometries, the trees over them, and rays. EmbreeSceneBuilder fills it.
#pragma once

#include "geometry/few_shapes.h"
#include "geometry/instance_table.h"
#include "render/intersector.h"
#include "render/shape.h"
#include "render/surface_hit.h"

#include <atomic>
#include <embree3/rtcore.h>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace abbe {

// A unique_ptr for an Embree handle: EmbreeHandle<RTCScene, rtcReleaseScene>.
template <typename Handle, void (*release)(Handle)> struct EmbreeRelease {
    using pointer = Handle;
    void operator()(Handle h) const { release(h); }
};
template <typename Handle, void (*release)(Handle)>
using EmbreeHandle = std::unique_ptr<std::remove_pointer_t<Handle>, EmbreeRelease<Handle, release>>;

// One device of Embree with threadCount() threads for building. Throws std::runtime_error if there can be none.
class EmbreeDevice {
  public:
    EmbreeDevice();
    RTCDevice get() const { return device_.get(); }
    // Throws std::runtime_error with the first error that Embree reported since the device was made, or std::bad_alloc.
    void throwIfFailed() const;

    struct Fault {
        RTCError code = RTC_ERROR_NONE;
        std::string text;
    };

  private:
    std::unique_ptr<Fault> firstError_; // a stable address for the callback
    EmbreeHandle<RTCDevice, rtcReleaseDevice> device_;
};

class Material;
class SurfaceLight;

enum class PrimitiveKind : std::uint8_t { triangles, quads, curves, points, analytic, instance };

// What a geometry id stands for: 32 bytes, one load per hit. Instances have no shape; `part` is their index.
struct GeometryRecord {
    const Shape* shape = nullptr;
    const Material* material = nullptr;
    const SurfaceLight* light = nullptr;
    std::uint32_t space = kUntextured; // position of the map to the shape's own space, for textures
    std::uint16_t part = 0;
    PrimitiveKind kind = PrimitiveKind::instance;
    std::uint8_t steps = 1; // in time

    static constexpr std::uint32_t kUntextured = 0xffffffffu; // no material of it looks at textures
};
static_assert(sizeof(GeometryRecord) == 32);

// Embree accepts hits at the near end itself: without this a ray that starts on a plane through the origin, where the
// error bound is 0, would hit it again at distance 0.
inline constexpr float kNearestHit = std::numeric_limits<float>::min();
// A shape as trees know it: whatever it is made of and emits.
struct ShapeUse {
    const Shape* shape = nullptr; // Shape::primitives()
    Visibility visible;
    bool skippable = false; // rays can be told not to see it, though it is a mesh (RayContext::skips)

    bool operator==(const ShapeUse&) const = default;
};

// What a geometry id stands for, of the shape that it is part of.
struct GeometrySlot {
    std::uint16_t part = 0;
    PrimitiveKind kind = PrimitiveKind::instance;
    std::uint8_t steps = 1; // in time
};

// Turns the primitives of shapes into geometries of one Embree scene, numbered in order, with a slot for each at the
// end of `slots`. Refers to the shapes and their data (see EmbreeSceneBuilder).
class EmbreeSink final : public GeometrySink {
  public:
    EmbreeSink(RTCDevice, RTCScene, std::vector<GeometrySlot>& slots);

    void add(const ShapeUse&);

    void triangles(TimeSteps<Vec3>, Triangles) override;
    void quads(TimeSteps<Vec3>, Quads) override;
    void curves(CurveBasis, CurveForm, TimeSteps<SizedPoint>, std::span<const std::uint32_t> firstPoints,
                std::span<const std::uint8_t> neighbours) override;
    void points(PointForm, TimeSteps<SizedPoint>, TimeSteps<Vec3> normals) override;
    void analytic(const Bounds3&) override;

  private:
    void mesh(RTCGeometryType, RTCFormat, TimeSteps<Vec3> vertices, const void* indices, std::size_t stride,
              std::size_t count);
    template <typename T> void shareSteps(RTCGeometry, RTCBufferType, RTCFormat, TimeSteps<T>);
    void attach(RTCGeometry, PrimitiveKind);

    RTCDevice device_;
    RTCScene scene_;
    std::vector<GeometrySlot>& slots_;
    std::size_t first_;
    ShapeUse use_; // that the next ones are of
    GeometrySlot next_;
};

// Sets the mask, commits and hands the geometry over to the scene under the given number.
void attachGeometry(RTCScene, RTCGeometry, std::size_t id, Visibility);

// Where a segment ends for occlusion: the surface that its end point belongs to is hit at 1 give or take the rounding
// of Embree's distance, a few ulp.
inline constexpr float kBeforeEnd = 1 - 0x1p-20f;

// A tree over shapes in one space, without those that are placed in it.
struct ShapeTree {
    std::shared_ptr<const EmbreeDevice> device;       // outlives the scene
    std::vector<std::shared_ptr<const Shape>> owners; // of the shapes, where others may still need the tree
    EmbreeHandle<RTCScene, rtcReleaseScene> scene;
    std::vector<ShapeUse> uses;
    std::vector<GeometrySlot> slots;     // by geometry id
    std::vector<std::size_t> firstSlots; // of each use, and one past the last
    bool leaf = true;                    // nothing is placed in it
};

// What rays meet, and nothing of what it is made of: immutable, and shared by all scenes that differ in materials and
// lights alone.
struct EmbreeStructure {
    std::shared_ptr<const ShapeTree> top;
    std::vector<std::shared_ptr<const ShapeTree>> objects;
    std::vector<std::unique_ptr<const InstanceTable>> tables;
    std::unique_ptr<const FewShapes> few; // all there is to be hit, if it is little; else null
    Bounds3 bounds;
    bool moving = false; // anything
    // What holds a table, the object that it places, and the rays that see it, as bits.
    struct Placed {
        std::uint32_t holder = 0, object = 0, visible = 0;
        auto operator<=>(const Placed&) const = default;
    };
    std::vector<Placed> placed; // like tables
};

class EmbreeScene final : public Intersector {
  public:
    explicit EmbreeScene(std::shared_ptr<const EmbreeStructure> built)
        : structure(std::move(built)), scene(structure->top->scene.get()), few(structure->few.get()),
          moving(structure->moving) {}

    bool intersect(const Ray&, SurfaceHit&) const noexcept override;
    bool occluded(const Ray&) const noexcept override;
    bool occluded(Vec3 from, Vec3 to, float time, RayKind kind) const noexcept override {
        return occluded({from, to - from, kBeforeEnd, time, kind});
    }
    std::size_t coincident(const Ray&, const SurfaceHit&, std::span<SurfaceHit>) const noexcept override;
    std::optional<Passage> passage(const Ray&, const SurfaceHit&, float distance) const noexcept override;
    Bounds3 bounds() const override { return structure->bounds; }
    std::uint64_t rejectedRays() const override { return rejected_.load(std::memory_order_relaxed); }

    std::shared_ptr<const EmbreeStructure> structure;
    std::vector<GeometryRecord> records; // of the top scene by geometry id, then of each object
    std::vector<OwnSpace> ownSpaces;     // GeometryRecord::space

  private:
    using Path = std::span<const PlacementStep>; // from the scene to the object that was hit

    RTCScene scene;       // the structure's
    const FewShapes* few; // likewise
    bool moving;

    bool nearest(const Ray&, RayContext&, RTCRayHit&) const;
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
