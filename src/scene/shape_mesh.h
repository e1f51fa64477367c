// Polygon meshes as the language states them.
#pragma once

#include "geometry/shape_params.h"
#include "io/gltf.h"
#include "scene/shape_builder.h"

#include <optional>
#include <vector>

namespace abbe {

struct MeshParams : ShapeParams {
    schema::Text file; // resolved path, or empty: points and faces
    std::vector<Vec3d> points;
    schema::IndexRows faces;
    std::vector<double> uvs; // pairs, one for each point
    std::vector<schema::NamedNumbers> attributes;
    std::vector<ShapeKey> keys; // instead of file and points: it deforms
    bool materials =
        false; // those of the file: such a shape is replaced before a scene is built (app/imported_scene.h)
};

schema::TypeInfo meshType();

// What the keys behind the name of a glTF file ask for.
GltfSelection gltfSelection(const schema::Text& file);

// What to take off the points of a mesh that is small against its distance from the origin, before they are rounded to
// single precision, and to put back in front of the map that places it (docs/hard_cases.md, case 7). 0 for others.
Vec3d farMiddle(const std::vector<Vec3d>& points);
std::vector<Vec3d> relativeTo(Vec3d origin, std::vector<Vec3d> points);

// A mesh in its own space: from a file (OBJ or PLY, with coordinates times `unit`, or glTF, in metres and turned where
// z is up; told apart by content) or from points and faces. Cleaned and checked. `groups` receives those of a file.
std::optional<MeshData> loadMesh(const schema::Text& file, double unit, const std::vector<Vec3d>& points,
                                 const schema::IndexRows& faces, Span, Diagnostics&, bool zUp = false,
                                 FaceGroups* groups = nullptr);
// The same, neither cleaned nor checked for more than the indices of faces that are written in place.
std::optional<MeshData> statedMesh(const schema::Text& file, double unit, const std::vector<Vec3d>& points,
                                   const schema::IndexRows& faces, Span, Diagnostics&, bool zUp, FaceGroups* groups);
// `attribute` of a type whose points are written in place.
template <typename P> schema::FieldInfo attributeField() {
    using namespace schema;
    return field<P, std::vector<NamedNumbers>>(FieldType::namedNumbers, "attribute", &P::attributes)
        .synonyms({"primvar", "vertex-attribute", "attributes", "colors"})
        .doc("A name and a number, or a colour of three, for each of `points`: what the texture `attribute` shows.")
        .example("attribute \"wear\" 0 0.5 1 0.2");
}

// Adds what is written in place for the points of a mesh or cage: one number each or three. `ofFile`: the points are
// from a file, which has its own. False after an error.
bool addAttributes(const std::vector<schema::NamedNumbers>&, bool ofFile, std::size_t points,
                   std::vector<MeshAttribute>& to, Diagnostics&);
// The texture coordinates and attributes of a mesh that is written in place. False after an error located at `span`.
bool addPointData(const MeshParams&, bool ofFile, MeshData&, Span, Diagnostics&);

} // namespace abbe
