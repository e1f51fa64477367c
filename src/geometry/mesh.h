// Polygon meshes: triangles and quads as they are, no subdivision.
#pragma once

#include "geometry/quad.h"
#include "math/mesh_data.h"
#include "render/shape.h"

#include <memory>
#include <utility>

namespace abbe {

struct MeshCorners;

// How the vertex normals of a mesh agree with its faces; corners are counted, one per face and vertex.
struct NormalReport {
    std::uint64_t missing = 0;  // zero or not finite: the face normal is used
    std::uint64_t inverted = 0; // on the far side of the face: turned to the near side when shaded
};

// Flat-shaded without vertex normals. uv are the barycentrics of the primitive when the data have none.
// Requires data that cleanMesh() has accepted: indices in range, finite positions.
class Mesh final : public Shape, public SurfaceSampling, public VertexAttributes {
  public:
    // `mirrored`: faces were turned round, because the map that placed them is a mirror.
    explicit Mesh(MeshData, bool mirrored = false);
    ~Mesh() override;

    const MeshData& data() const { return data_; }
    const NormalReport& normalReport() const { return normalReport_; }

    Bounds3 bounds() const override { return bounds_; }
    void commit(GeometrySink&) const override;
    // Primitives are numbered triangles first, then quads.
    void surface(const RawHit&, const Ray&, SurfaceHit&) const override;
    void parametrize(const RawHit&, const Ray&, SurfaceHit&) const override;
    bool hasTextureCoordinates() const override { return !data_.uvs.empty(); }
    float meanCurvature(const SurfaceHit&) const override; // of its triangle; 0 without vertex normals
    std::optional<SurfacePatch> patch(const SurfaceHit&, Vec3d origin, Vec3d direction) const noexcept override;
    Relief relief() const override { return data_.normals.empty() ? Relief::facets : Relief::smooth; }
    const SurfaceSampling* sampling() const override { return this; }
    const VertexAttributes* attributes() const override { return this; }
    std::optional<Vec3> attribute(std::string_view, const SurfaceHit&) const override;
    std::vector<std::string_view> attributeNames() const override;
    double area() const override { return area_; }
    std::uint32_t emitterParts() const override;
    EmitterPart emitterPart(std::uint32_t) const override;
    // A lone quad as Quad does; polygons seen large as NearPolygon does, others uniform per area.
    std::optional<ShapeSample> sample(const Receiver&, std::uint32_t part, Vec2 u) const override;
    float pdfSolidAngle(const Receiver&, const SurfaceHit&) const override;
    std::optional<ShapePoint> samplePoint(std::uint32_t part, Vec2 u) const override;
    float pdfPoint(std::uint32_t part, Vec3 ng) const override;
    std::optional<RawHit> locate(Vec3 p, std::uint32_t part, const Ray&) const override;

  private:
    std::uint64_t triangleCount() const { return data_.triangles.size() + 2 * data_.quads.size(); }
    std::array<std::uint32_t, 3> triangle(std::uint64_t) const; // quads count as two
    double triangleArea(std::uint64_t) const;
    std::pair<std::uint64_t, int> trianglesOf(std::uint32_t primitive) const;
    double partArea(std::uint32_t primitive) const;
    struct TrianglePoint {
        std::uint64_t triangle;
        Vec2 weights; // barycentric
    };
    TrianglePoint pointOfPart(std::uint32_t primitive, double area, Vec2 u) const; // even per area
    void shade(const MeshCorners&, SurfaceHit&) const;
    void countNormals();

    MeshData data_;
    std::vector<Vec3> faceNormals_; // per triangle, then two per quad
    Bounds3 bounds_;
    NormalReport normalReport_;
    double area_ = 0;
    bool mirrored_;
    std::unique_ptr<const Quad> lone_; // the mesh itself if it is a single quad
};

} // namespace abbe
