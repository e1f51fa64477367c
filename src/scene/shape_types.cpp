#include "scene/shape_types.h"

#include "scene/shape_fields.h"

namespace abbe {

using namespace schema;

namespace {

template <typename P> FieldInfo radiusField() {
    return field<P, double>(FieldType::quantity, "radius", &P::radius)
        .unit({Dimension::length})
        .range(1e-30, 1e15)
        .byDefault("0.5")
        .synonyms({"r", "size"})
        .doc("Radius.")
        .example("radius 0.5 m");
}

template <typename P> FieldInfo normalField() {
    return field<P, std::optional<Vec3d>>(FieldType::vector3, "normal", &P::normal)
        .unit({Dimension::none})
        .doc("Direction of the outer side, of any length; up when absent.")
        .example("normal 0 1 0");
}

} // namespace

TypeInfo quadType() {
    using P = QuadParams;
    std::vector<FieldInfo> fields = {
        field<P, std::vector<Vec3d>>(FieldType::points, "points", &P::points)
            .unit({Dimension::length})
            .group("extent")
            .doc("Four corners, counter-clockwise seen from the outer side.")
            .example("points 0 0 0   1 0 0   1 1 0   0 1 0"),
        field<P, Vec2d>(FieldType::vector2, "size", &P::size)
            .unit({Dimension::length})
            .range(1e-30, 1e15)
            .group("extent")
            .doc("Width and height of a rectangle about the origin in the xy-plane, facing +z; 1 1 when absent.")
            .example("size 60 120 cm"),
    };
    addShapeFields<P>(fields);
    return {Kind::shape, "quad",           "Flat four-cornered surface.", "shape quad { size 2 1; material diffuse }",
            false,       std::move(fields)};
}

TypeInfo sphereType() {
    using P = SphereParams;
    std::vector<FieldInfo> fields = {centerField<P>("Centre."), radiusField<P>()};
    addShapeFields<P>(fields);
    return {Kind::shape, "sphere",         "Exact sphere.", "shape sphere { center 0 0.5 0; radius 0.5 }",
            false,       std::move(fields)};
}

TypeInfo diskType() {
    using P = DiskParams;
    std::vector<FieldInfo> fields = {centerField<P>("Centre."), normalField<P>(), radiusField<P>()};
    addShapeFields<P>(fields);
    return {
        Kind::shape, "disk",           "Flat round surface.", "shape disk { center 0 2 0; normal 0 -1 0; radius 0.3 }",
        false,       std::move(fields)};
}

TypeInfo planeType() {
    using P = PlaneParams;
    std::vector<FieldInfo> fields = {centerField<P>("A point of the plane."), normalField<P>()};
    addShapeFields<P>(fields);
    return {Kind::shape, "plane",          "Infinite plane, the ground by default.", "shape plane { material diffuse }",
            false,       std::move(fields)};
}

TypeInfo meshType() {
    using P = MeshParams;
    std::vector<FieldInfo> fields = {
        field<P, Text>(FieldType::file, "file", &P::file)
            .argument(0)
            .group("source")
            .synonyms({"filename", "path"})
            .key({"node", {}, "Take this node of a glTF file, and those below it."})
            .key({"mesh", {}, "Take this mesh of a glTF file."})
            .doc("OBJ, PLY or glTF file, binary or text; quads are kept. glTF is in metres, with y up.")
            .example("file \"bunny.ply\""),
        field<P, std::vector<Vec3d>>(FieldType::points, "points", &P::points)
            .unit({Dimension::length})
            .group("source")
            .synonyms({"vertices", "P", "positions"})
            .doc("Vertex positions, one row of three numbers each, or one long list.")
            .example("points { - 0 0 0; - 1 0 0; - 0 1 0 }"),
        field<P, IndexRows>(FieldType::indexRows, "faces", &P::faces)
            .synonyms({"indices", "triangles", "polygons"})
            .doc("Rows of vertex numbers from 0, counter-clockwise seen from outside; polygons of any size.")
            .example("faces { - 0 1 2 }"),
        field<P, std::vector<double>>(FieldType::numbers, "uvs", &P::uvs)
            .synonyms({"st", "texture-coordinates", "vt", "uv"})
            .doc("Texture coordinates, two numbers for each of `points`.")
            .example("uvs { - 0 0; - 1 0; - 0 1 }"),
        attributeField<P>(),
    };
    fields.push_back(keysField<P>(meshKeyFields()));
    addGroupedShapeFields<P>(fields);
    return {Kind::shape,
            "mesh",
            "Polygon mesh from a file or written in place.",
            "shape mesh \"teapot.obj\" { material diffuse }",
            false,
            std::move(fields)};
}

} // namespace abbe
