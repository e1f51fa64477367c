// Shapes of Mitsuba's: geometry, material, light and inside.
#pragma once

#include "exchange/mitsuba/context.h"
#include "math/mesh_data.h"

namespace abbe::exchange {

// A shape, shape group or instance becomes nodes of the scene, or of `parent`, the object of a shape group.
void convertShape(const XmlObject&, SceneNode* parent, MitsubaContext&);

// What geometry tells of itself.
struct ShapeForm {
    bool shown = false;  // false: nothing could be made of it
    bool closed = false; // nobody sees it from behind
    bool turned = false; // its v grows upwards in Mitsuba, so that our tangents across u point the other way
};

// Writes type, measures and transform of a shape whose material is known. mesh_shapes.cpp has those of triangles and
// curves.
ShapeForm writeGeometry(SceneNode&, const XmlObject&, const MaterialTraits&, MitsubaContext&);
ShapeForm writeMeshFile(SceneNode&, const XmlObject&, const MaterialTraits&, MitsubaContext&);
ShapeForm writeMesh(SceneNode&, MeshData, const XmlObject&, MitsubaContext&);
ShapeForm writeCurves(SceneNode&, const XmlObject&, MitsubaContext&);

// Texture coordinates of Mitsuba's as ours: `to_uv` of the material, then v turned over.
void turnCoordinates(MeshData&, const MaterialTraits&);

// Meshes of a .serialized file (serialized_file.cpp). Throws IoError.
MeshData readSerializedMesh(const std::string& path, std::size_t index);

} // namespace abbe::exchange
