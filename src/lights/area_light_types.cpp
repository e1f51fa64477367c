#include "lights/area_light_types.h"

#include "lights/amount.h"

namespace abbe {

namespace {

using schema::Dimension;
using schema::FieldInfo;
using schema::FieldType;

// m: far beyond any scene, far from overflow; and far below an atom, so that the solid angle of the smallest light at
// 10 000 km is a number of single precision.
constexpr double kLargest = 1e12, kSmallest = 1e-15;

template <typename Params> void addCommonFields(std::vector<FieldInfo>& fields) {
    addAmountFields<Params>(fields, kAreaAmounts);
    for (FieldInfo& field : fields)
        if (field.name == "radiance") field.texturable = true;
    fields.push_back(schema::field<Params, schema::Reference>(FieldType::reference, "texture", &Params::texture)
                         .to(schema::Kind::texture)
                         .doc("Picture or pattern that dims and colours the light over the surface: a factor of its "
                              "radiance. `power` is that of the whole all the same; `luminance` is where it is 1.")
                         .example("texture checker { even 1; odd 0.1; scale 4 }")
                         .synonyms({"filename", "map", "emission_map", "image"}));
    fields.push_back(schema::field<Params, bool>(FieldType::toggle, "two-sided", &Params::twoSided)
                         .byDefault("off")
                         .doc("Emit the same radiance from the inner side too; `power` counts both sides.")
                         .example("two-sided on")
                         .synonyms({"twosided", "double-sided"}));
    fields.push_back(visibleField<Params>());
    fields.push_back(schema::field<Params, KeyedTransform>(FieldType::transform, "transform", &Params::transform)
                         .doc("Places the light: steps from top to bottom, as applied to it.")
                         .example("transform { rotate x 90 deg; translate 0 2 0 }")
                         .synonyms({"to-world", "matrix"}));
}

template <typename Params> schema::Field centerField() {
    return schema::field(FieldType::vector3, "center", &Params::center)
        .unit({Dimension::length})
        .byDefault("0 0 0")
        .doc("Middle of the light.")
        .example("center 0 2.4 0")
        .synonyms({"centre", "position"});
}

template <typename Params> schema::Field radiusField() {
    return schema::field(FieldType::quantity, "radius", &Params::radius)
        .unit({Dimension::length})
        .byDefault("0.5 m")
        .range(kSmallest, kLargest)
        .doc("Radius.")
        .example("radius 15 cm")
        .synonyms({"r"});
}

} // namespace

schema::TypeInfo lightQuadType() {
    schema::TypeInfo type{.kind = schema::Kind::light,
                          .name = "quad",
                          .doc = "A flat rectangle or four-cornered patch that emits from its front.",
                          .example = "light quad { size 60 120 cm; power 2400 lm }",
                          .isDefault = true,
                          .fields = {}};
    type.fields.push_back(schema::field(FieldType::points, "points", &LightQuadParams::points)
                              .unit({Dimension::length})
                              .group("extent")
                              .doc("Four corners, counter-clockwise seen from the emitting side.")
                              .example("points 0 2 0  1 2 0  1 2 1  0 2 1")
                              .synonyms({"vertices", "corners", "P"}));
    type.fields.push_back(schema::field(FieldType::vector2, "size", &LightQuadParams::size)
                              .unit({Dimension::length})
                              .group("extent")
                              .range(kSmallest, kLargest)
                              .doc("Width and height of a rectangle about the origin that faces +z. Default 1 1 m.")
                              .example("size 60 120 cm")
                              .synonyms({"width", "height", "extent"}));
    addCommonFields<LightQuadParams>(type.fields);
    return type;
}

schema::TypeInfo lightDiskType() {
    schema::TypeInfo type{.kind = schema::Kind::light,
                          .name = "disk",
                          .doc = "A flat disk that emits from its front.",
                          .example = "light disk { center 0 2 0; normal 0 -1 0; radius 20 cm; power 800 lm }",
                          .fields = {}};
    type.fields.push_back(centerField<LightDiskParams>());
    type.fields.push_back(schema::field(FieldType::vector3, "normal", &LightDiskParams::normal)
                              .byDefault("0 0 1")
                              .doc("Direction that the disk faces, of any length.")
                              .example("normal 0 -1 0")
                              .synonyms({"direction", "toward"}));
    type.fields.push_back(radiusField<LightDiskParams>());
    addCommonFields<LightDiskParams>(type.fields);
    return type;
}

schema::TypeInfo lightSphereType() {
    schema::TypeInfo type{.kind = schema::Kind::light,
                          .name = "sphere",
                          .doc = "A sphere that emits outwards.",
                          .example = "light sphere { center 0 2 0; radius 5 cm; power 800 lm }",
                          .fields = {}};
    type.fields.push_back(centerField<LightSphereParams>());
    type.fields.push_back(radiusField<LightSphereParams>());
    addCommonFields<LightSphereParams>(type.fields);
    return type;
}

schema::TypeInfo lightMeshType() {
    schema::TypeInfo type{.kind = schema::Kind::light,
                          .name = "mesh",
                          .doc = "A polygon mesh that emits from the outer side of all its faces.",
                          .example = "light mesh { points { - 0 2 0; - 1 2 0; - 0 2 1 }; faces { - 0 1 2 }; "
                                     "luminance 5000 nits }",
                          .fields = {}};
    type.fields.push_back(schema::field(FieldType::file, "file", &LightMeshParams::file)
                              .argument(0)
                              .group("mesh")
                              .doc("OBJ or PLY file.")
                              .example("file \"lamp.ply\"")
                              .synonyms({"filename", "path"}));
    type.fields.push_back(schema::field(FieldType::points, "points", &LightMeshParams::points)
                              .unit({Dimension::length})
                              .group("mesh")
                              .doc("Vertices, instead of a file.")
                              .example("points { - 0 2 0; - 1 2 0; - 0 2 1 }")
                              .synonyms({"vertices", "P"}));
    type.fields.push_back(schema::field(FieldType::indexRows, "faces", &LightMeshParams::faces)
                              .doc("One row of vertex numbers for each face, counter-clockwise seen from outside.")
                              .example("faces { - 0 1 2 }")
                              .synonyms({"indices", "polygons"}));
    addCommonFields<LightMeshParams>(type.fields);
    return type;
}

} // namespace abbe
