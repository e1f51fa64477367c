// Shapes as Embree geometries.
#pragma once

#include "render/shape.h"

#include <embree3/rtcore.h>
#include <limits>
#include <vector>

namespace abbe {

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
// error bound is 0, would meet it again at distance 0.
inline constexpr float kNearestHit = std::numeric_limits<float>::min();
// Turns the primitives of shapes into geometries of one Embree scene, numbered in order, with a record for each at the
// end of `records`. Refers to the shapes and their data (see EmbreeSceneBuilder).
class EmbreeSink final : public GeometrySink {
  public:
    // `nested`: meshes of dielectrics can be skipped by rays (RayContext::skips).
    EmbreeSink(RTCDevice, RTCScene, std::vector<GeometryRecord>& records, bool nested);

    void add(const Shape&, const Material*, const SurfaceLight*, std::uint32_t space = GeometryRecord::kUntextured,
             Visibility = kVisibleToAll);

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
    std::vector<GeometryRecord>& records_;
    std::size_t firstRecord_;
    bool nested_;
    GeometryRecord next_;
    Visibility visible_; // of the next one
};

// Sets the mask, commits and hands the geometry over to the scene under the given number.
void attachGeometry(RTCScene, RTCGeometry, std::size_t id, Visibility);

} // namespace abbe
