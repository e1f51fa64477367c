// Polygon meshes: triangles and quads as they are, no subdivision. Checks a mesh and removes what cannot be rendered,
// and gives faces materials of their own.
#pragma once

#include "geometry/flat_shapes.h"
#include "math/mesh_data.h"
#include "render/shape.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace abbe {

struct MeshCleanup {
    std::uint64_t zeroArea = 0;         // faces removed: slivers of no measurable area
    std::uint64_t repeatedIndices = 0;  // faces removed: fewer than three different corners
    std::uint64_t quadsToTriangles = 0; // quads with one repeated corner
    // What makes the mesh unusable, naming the face or the vertex (from 0); the mesh is then unchanged.
    std::optional<std::string> error;

    std::uint64_t removed() const { return zeroArea + repeatedIndices; }
};

// Errors: indices beyond the vertices, positions, normals or uvs that are not finite, normals or uvs that are not one
// per vertex, more faces than 32 bits count. A face has no area if twice its area is below 1e-6 of the square of its
// longest edge and its area below 1e-12 of the square of the mesh's diagonal: small but well-shaped faces stay.
// Groups stay with their faces. Requires groups, where given, of as many faces as the mesh has.
MeshCleanup cleanMesh(MeshData&, FaceGroups* = nullptr);

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
    float meanCurvature(const SurfaceHit&) const override; // of its triangle; 0 without vertex normals
    std::optional<SurfacePatch> patch(const SurfaceHit&, Vec3d origin, Vec3d direction) const noexcept override;
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

// One geometry, so that there are no seams between materials: what is hit is the inner shape; only the material of the
// hit is another. `choice[SurfaceHit::primitive]` is a position in `materials`; where that is null, the hit keeps the
// material that the shape was bound to. Materials are referred to and must outlive this.
class FaceMaterials final : public Shape {
  public:
    // Requires a choice for every primitive of the shape, within `materials`.
    FaceMaterials(std::shared_ptr<const Shape> shape, std::vector<const Material*> materials,
                  std::vector<std::uint16_t> choice);

    const Shape& inner() const { return *shape_; }

    Bounds3 bounds() const override { return shape_->bounds(); }
    void commit(GeometrySink& sink) const override { shape_->commit(sink); }
    std::optional<RawHit> intersect(const Ray& ray) const override { return shape_->intersect(ray); }
    bool confirms(const RawHit& raw, const Ray& ray) const override { return shape_->confirms(raw, ray); }
    void surface(const RawHit&, const Ray&, SurfaceHit&) const override;
    void parametrize(const RawHit& raw, const Ray& ray, SurfaceHit& hit) const override {
        shape_->parametrize(raw, ray, hit);
    }
    Vec3 carried(const RawHit& raw, const Ray& ray, const SurfaceHit& hit, float time) const override {
        return shape_->carried(raw, ray, hit, time);
    }
    const SurfaceSampling* sampling() const override { return shape_->sampling(); }
    const VertexAttributes* attributes() const override { return shape_->attributes(); }
    float meanCurvature(const SurfaceHit& hit) const override { return shape_->meanCurvature(hit); }
    double area() const override { return shape_->area(); }

  private:
    std::shared_ptr<const Shape> shape_;
    std::vector<const Material*> materials_;
    std::vector<std::uint16_t> choice_;
};

} // namespace abbe
