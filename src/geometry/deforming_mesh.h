// A polygon mesh whose vertices move while the shutter is open.
#pragma once

#include "math/mesh_data.h"
#include "render/shape.h"

#include <vector>

namespace abbe {

// The vertices of a mesh at one time; `normals` as long as `positions`, or empty at all times.
struct MeshStep {
    std::vector<Vec3> positions;
    std::vector<Vec3> normals;
};

// As Mesh, but between equally spaced steps vertices move in straight lines. At any time the face normals are those of
// the faces as they are then; vertex normals are interpolated. Texture coordinates and attributes stay with
// their vertices.
class DeformingMesh final : public Shape, public VertexAttributes {
  public:
    // Requires data in which cleanMesh() finds no error at any step, and 2 … kMaxTimeSteps steps. The positions and
    // normals of `faces` itself are not used. Faces without area at some time are no fault.
    DeformingMesh(MeshData faces, std::vector<MeshStep> steps);

    std::size_t triangleCount() const { return faces_.triangles.size(); }
    std::size_t quadCount() const { return faces_.quads.size(); }
    std::size_t steps() const { return steps_.size(); }
    std::size_t bytes() const; // of the data that rays refer to, without the acceleration structure

    Bounds3 bounds() const override { return bounds_; } // at all times
    void commit(GeometrySink&) const override;
    // Primitives are numbered triangles first, then quads.
    void surface(const RawHit&, const Ray&, SurfaceHit&) const override;
    void parametrize(const RawHit&, const Ray&, SurfaceHit&) const override;
    Vec3 carried(const RawHit&, const Ray&, const SurfaceHit&, float time) const override;
    const VertexAttributes* attributes() const override { return this; }
    std::optional<Vec3> attribute(std::string_view, const SurfaceHit&) const override;
    std::vector<std::string_view> attributeNames() const override;
    double area() const override; // the largest of all steps

  private:
    MeshData faces_; // and texture coordinates, attributes
    std::vector<MeshStep> steps_;
    Bounds3 bounds_;
};

} // namespace abbe
