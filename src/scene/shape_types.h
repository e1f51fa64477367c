// The shapes of the language: what they may say, and how they become render-space geometry.
#pragma once

#include "base/diagnostic.h"
#include "math/mesh_data.h"
#include "math/motion.h"
#include "render/shape.h"
#include "render/visible_field.h"
#include "scene/shape_key.h"
#include "schema/type.h"

#include <memory>
#include <optional>
#include <vector>

namespace abbe {

// m: Embree takes coordinates up to about 1.8e18, and squares of them must stay finite in float.
inline constexpr double kLargestCoordinate = 1e15;

// What every shape has. The transform takes the shape to its parent (object, group or world).
struct ShapeParams : VisibleParams {
    schema::Reference material;                         // unset: grey diffuse
    std::vector<schema::GroupReference> groupMaterials; // of parts; mesh and subdivision only
    schema::Reference interior;                         // medium; unset: empty
    schema::TexturedSpectrum emission;                  // W·m⁻²·sr⁻¹·nm⁻¹ from the outer side
    KeyedTransform transform;

    bool emits() const { return emission.curve || emission.texture; }
};

struct QuadParams : ShapeParams {
    std::vector<Vec3d> points; // four corners, or empty
    Vec2d size{1, 1};
};
struct SphereParams : ShapeParams {
    Vec3d center;
    double radius = 0.5;
};
struct DiskParams : ShapeParams {
    Vec3d center;
    std::optional<Vec3d> normal; // unset: up
    double radius = 0.5;
};
struct PlaneParams : ShapeParams {
    Vec3d center;
    std::optional<Vec3d> normal; // unset: up
};
struct MeshParams : ShapeParams {
    schema::Text file; // resolved path, or empty: points and faces
    std::vector<Vec3d> points;
    schema::IndexRows faces;
    std::vector<double> uvs; // pairs, one for each point
    std::vector<schema::NamedNumbers> attributes;
    std::vector<ShapeKey> keys; // instead of file and points: it deforms
};

schema::TypeInfo quadType();
schema::TypeInfo sphereType();
schema::TypeInfo diskType();
schema::TypeInfo planeType();
schema::TypeInfo meshType();

// What to take off the points of a mesh that is small against its distance from the origin, before they are rounded to
// single precision, and to put back in front of the map that places it (docs/hard_cases.md, case 7). 0 for others.
Vec3d farMiddle(const std::vector<Vec3d>& points);
std::vector<Vec3d> relativeTo(Vec3d origin, std::vector<Vec3d> points);

// Shapes in the space that `place` leads to. Each returns null, or nothing, after an error located at `span`.
std::unique_ptr<const Shape> makeQuad(const std::vector<Vec3d>& points, Vec2d size, const Transform& place, Span,
                                      Diagnostics&);
std::unique_ptr<const Shape> makeSphere(Vec3d center, double radius, const Transform& place, Span, Diagnostics&);
std::unique_ptr<const Shape> makeDisk(Vec3d center, Vec3d normal, double radius, const Transform& place, Span,
                                      Diagnostics&);
std::unique_ptr<const Shape> makePlane(Vec3d point, Vec3d normal, const Transform& place, Span, Diagnostics&);
// A mesh in its own space: from a file (OBJ or PLY, with coordinates times `unit`, or glTF, in metres and turned where
// z is up; told apart by content) or from points and faces. Cleaned and checked. `groups` receives those of a file.
std::optional<MeshData> loadMesh(const schema::Text& file, double unit, const std::vector<Vec3d>& points,
                                 const schema::IndexRows& faces, Span, Diagnostics&, bool zUp = false,
                                 FaceGroups* groups = nullptr);
// The same, neither cleaned nor checked for more than the indices of faces that are written in place.
std::optional<MeshData> statedMesh(const schema::Text& file, double unit, const std::vector<Vec3d>& points,
                                   const schema::IndexRows& faces, Span, Diagnostics&, bool zUp, FaceGroups* groups);
// Adds what is written in place for the points of a mesh or cage: one number each or three. `ofFile`: the points are
// from a file, which has its own. False after an error.
bool addAttributes(const std::vector<schema::NamedNumbers>&, bool ofFile, std::size_t points,
                   std::vector<MeshAttribute>& to, Diagnostics&);
// The texture coordinates and attributes of a mesh that is written in place. False after an error located at `span`.
bool addPointData(const MeshParams&, bool ofFile, MeshData&, Span, Diagnostics&);
// Normals stay outward under mirrors.
std::unique_ptr<const Shape> placeMesh(MeshData, const Transform& place, Span, Diagnostics&);

} // namespace abbe
