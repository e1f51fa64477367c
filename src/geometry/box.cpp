#include "geometry/box.h"

#include "geometry/place_shape.h"

namespace abbe {

namespace {

schema::FieldInfo cornerField(std::string_view name, std::optional<Vec3d> BoxParams::*member, std::string_view doc,
                              std::string_view example) {
    return schema::field<BoxParams, std::optional<Vec3d>>(schema::FieldType::vector3, name, member)
        .unit({schema::Dimension::length})
        .doc(doc)
        .example(example);
}

std::optional<std::string> boxFault(const BoxParams& p) {
    if (p.size && (p.min || p.max)) return "a box has a `size` or two corners, not both";
    if (p.min.has_value() != p.max.has_value()) return "`min` and `max` of a box belong together";
    if (p.min && !(p.min->x < p.max->x && p.min->y < p.max->y && p.min->z < p.max->z))
        return "`min` of a box lies below `max` in x, y and z";
    if (p.min && length(p.center) > 0) return "`min` and `max` place a box without `center`";
    return std::nullopt;
}

} // namespace

MeshData boxMesh(Vec3d lower, Vec3d upper) {
    MeshData mesh;
    mesh.positions.reserve(8);
    for (int i = 0; i < 8; ++i) // bit 0: x, bit 1: y, bit 2: z
        mesh.positions.push_back(Vec3(Vec3d{(i & 1) != 0 ? upper.x : lower.x, (i & 2) != 0 ? upper.y : lower.y,
                                            (i & 4) != 0 ? upper.z : lower.z}));
    mesh.quads = {{0, 4, 6, 2}, {5, 1, 3, 7}, {0, 1, 5, 4}, {6, 7, 3, 2}, {1, 0, 2, 3}, {4, 5, 7, 6}};
    return mesh;
}

schema::TypeInfo boxType() {
    using namespace schema;
    using P = BoxParams;
    std::vector<FieldInfo> fields = {
        centerField<P>("Centre; not beside `min` and `max`."),
        field<P, std::optional<Vec3d>>(FieldType::vector3, "size", &P::size)
            .unit({Dimension::length})
            .range(1e-30, 1e15)
            .synonyms({"dimensions", "extent"})
            .doc("Lengths of the edges along x, y and z; 1 1 1 when absent.")
            .example("size 20 10 30 cm"),
        cornerField("min", &P::min, "Corner with the smallest coordinates, instead of `size`.", "min -1 0 -1"),
        cornerField("max", &P::max, "Corner with the largest coordinates, together with `min`.", "max 1 2 1"),
    };
    addShapeFields<P>(fields);
    return {Kind::shape,      "box", "Box of six flat faces.", "shape box { size 2 1 1; material diffuse }", false,
            std::move(fields)};
}

std::optional<UnplacedShape> makeBox(const BoxParams& params, const ShapeContext& context) {
    if (const auto fault = boxFault(params)) {
        context.diagnostics.error("E0614", context.span, *fault).help =
            "`size 1 2 1` with `center`, or `min 0 0 0; max 1 2 1`";
        return std::nullopt;
    }
    const Vec3d size = params.min ? *params.max - *params.min : params.size.value_or(Vec3d{1, 1, 1});
    UnplacedShape shape;
    shape.mesh = std::make_shared<const MeshData>(boxMesh(size * -0.5, size * 0.5));
    shape.meshOrigin = params.min ? (*params.min + *params.max) * 0.5 : params.center;
    shape.uvOnFaces = true;
    shape.place = [mesh = shape.mesh, origin = shape.meshOrigin, context](const Transform& place) {
        return placeMesh(*mesh, Transform::translate(origin).then(place), context.span, context.diagnostics);
    };
    return shape;
}

} // namespace abbe
