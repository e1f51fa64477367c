#include "scene/shape_key.h"

namespace abbe {

using namespace schema;

namespace {

using K = ShapeKey;

FieldInfo fileField() {
    return field(FieldType::file, "file", &K::file)
        .key({"node", {}, "Take this node of a glTF file, and those below it."})
        .key({"mesh", {}, "Take this mesh of a glTF file."})
        .doc("File with the points at this time.")
        .example("file \"flag.0102.ply\"");
}

FieldInfo pointsField() {
    return field(FieldType::points, "points", &K::points)
        .unit({Dimension::length})
        .doc("Points at this time, one row of three numbers each, or one long list.")
        .example("points { - 0 0 0; - 1 0 0; - 1 1 0.2 }");
}

} // namespace

std::vector<FieldInfo> meshKeyFields() { return {fileField(), pointsField()}; }

std::vector<FieldInfo> curvesKeyFields() {
    return {fileField(), pointsField(),
            field(FieldType::quantity, "radius", &K::radius)
                .unit({Dimension::length})
                .range(0, 1e15)
                .doc("Radius everywhere at this time.")
                .example("radius 0.05 mm"),
            field(FieldType::numbers, "radii", &K::radii)
                .unit({Dimension::length})
                .range(0, 1e15)
                .doc("Radius at each point at this time.")
                .example("radii 2 2 1 0 mm")};
}

std::vector<FieldInfo> pointsKeyFields() {
    std::vector<FieldInfo> fields = curvesKeyFields();
    fields.push_back(field(FieldType::points, "normals", &K::normals)
                         .unit({Dimension::none})
                         .doc("Direction of the outer side of each disk at this time.")
                         .example("normals { - 0 1 0; - 0 1 0.5 }"));
    return fields;
}

} // namespace abbe
