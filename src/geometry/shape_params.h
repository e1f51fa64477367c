// What every shape of the language has, and what a type of shapes is made with (docs/adding_a_shape.md): its
// parameters, and shapes in the space that a map leads to, with what keeps them out of it.
#pragma once

#include "base/diagnostic.h"
#include "math/mesh_data.h"
#include "math/motion.h"
#include "render/shape.h"
#include "render/visible_field.h"
#include "schema/type.h"

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

// m: Embree takes coordinates up to about 1.8e18, and squares of them must stay finite in float.
inline constexpr double kLargestCoordinate = 1e15;

// The transform takes the shape to its parent (object, group or world).
struct ShapeParams : VisibleParams {
    schema::Reference material;                         // unset: grey diffuse
    std::vector<schema::GroupReference> groupMaterials; // of parts; mesh and subdivision only
    schema::Reference interior;                         // medium; unset: empty
    schema::TexturedSpectrum emission;                  // W·m⁻²·sr⁻¹·nm⁻¹ from the outer side
    KeyedTransform transform;

    bool emits() const { return emission.curve || emission.texture; }
};

// What making a shape needs besides its own parameters. Lives as long as what is made of it.
struct ShapeContext {
    Span span; // of the definition's head
    Diagnostics& diagnostics;
    Vec3d up{0, 1, 0};
    double unit = 1; // m per unit of length of a file that states none
    bool zUp = false;
    const Interval& shutter;         // known when the shape is placed, not yet when it is made
    std::vector<std::string>& files; // receives those that were read
};

// A shape whose geometry is known but not yet its place: it stands once in the scene or, if it is a light or infinite,
// once for every instance of the object that it is in.
struct UnplacedShape {
    // The shape in the space that the map leads to; null after an error. Requires `place` to be set.
    std::function<std::unique_ptr<const Shape>(const Transform&)> place;
    std::shared_ptr<const MeshData> mesh; // of what consists of polygons
    Vec3d meshOrigin;                     // in the shape's own space; positions of `mesh` are relative to it
    std::string_view openBecause;         // why no medium can fill it, if so
    std::size_t quads = 0;                // polygons without a `mesh`, for `abbe info`
    bool infinite = false;
    bool uvOnFaces = false; // each face has texture coordinates, whatever Shape::hasTextureCoordinates() says of all
};

template <typename P> void addShapeFields(std::vector<schema::FieldInfo>& fields) {
    using namespace schema;
    fields.push_back(field<P, Reference>(FieldType::reference, "material", &P::material)
                         .to(Kind::material)
                         .synonyms({"bsdf", "shader", "surface"})
                         .doc("Name of a material, or one written in place; grey and matte when absent.")
                         .example("material diffuse { reflectance 0.5 }"));
    fields.push_back(field<P, Reference>(FieldType::reference, "interior", &P::interior)
                         .to(Kind::medium)
                         .synonyms({"medium", "interior_medium", "inside", "volume"})
                         .doc("Medium that fills the closed shape: its name, or one written in place.")
                         .example("interior homogeneous { extinction 20 per-m }"));
    fields.push_back(
        field<P, TexturedSpectrum>(FieldType::spectrum, "emission", &P::emission)
            .role(SpectrumRole::emission)
            .synonyms({"emitter", "glow", "Le"})
            .doc("Spectral radiance that leaves the outer side, in W per m², sr and nm, or a texture of it.")
            .example("emission 0.5"));
    fields.push_back(visibleField<P>());
    fields.push_back(field<P, KeyedTransform>(FieldType::transform, "transform", &P::transform)
                         .synonyms({"to_world", "toWorld", "xform"})
                         .doc("Places the shape: steps from top to bottom, as applied to the object.")
                         .example("transform { scale 2; rotate y 45 deg; translate 0 1 0 }"));
}

// For shapes of polygons: materials of parts.
template <typename P> void addGroupedShapeFields(std::vector<schema::FieldInfo>& fields) {
    using namespace schema;
    fields.push_back(
        field<P, Reference>(FieldType::reference, "material", &P::material)
            .groups(&P::groupMaterials)
            .to(Kind::material)
            .key({"group", {}, "For the faces of one group of the file alone; may be repeated with other groups."})
            .synonyms({"bsdf", "shader", "surface"})
            .doc("Name of a material, or one written in place; grey and matte when absent.")
            .example("material diffuse { reflectance 0.5 }"));
    const std::size_t plain = fields.size();
    addShapeFields<P>(fields);
    fields.erase(fields.begin() + static_cast<std::ptrdiff_t>(plain)); // its `material`
}

template <typename P> schema::FieldInfo centerField(std::string_view what) {
    return schema::field<P, Vec3d>(schema::FieldType::vector3, "center", &P::center)
        .unit({schema::Dimension::length})
        .byDefault("0 0 0")
        .synonyms({"centre", "position", "origin"})
        .doc(what)
        .example("center 0 0.5 0");
}

template <typename P> schema::FieldInfo radiusField() {
    return schema::field<P, double>(schema::FieldType::quantity, "radius", &P::radius)
        .unit({schema::Dimension::length})
        .range(1e-30, 1e15)
        .byDefault("0.5")
        .synonyms({"r", "size"})
        .doc("Radius.")
        .example("radius 0.5 m");
}

template <typename P>
schema::FieldInfo lengthField(std::string_view name, double P::*member, double least, std::string byDefault,
                              std::string_view doc, std::string_view example, std::vector<std::string_view> synonyms) {
    return schema::field<P, double>(schema::FieldType::quantity, name, member)
        .unit({schema::Dimension::length})
        .range(least, 1e15)
        .byDefault(std::move(byDefault))
        .synonyms(std::move(synonyms))
        .doc(doc)
        .example(example);
}

template <typename P> schema::FieldInfo normalField() {
    return schema::field<P, std::optional<Vec3d>>(schema::FieldType::vector3, "normal", &P::normal)
        .unit({schema::Dimension::none})
        .doc("Direction of the outer side, of any length; up when absent.")
        .example("normal 0 1 0");
}

template <typename P> schema::FieldInfo axisField() {
    return schema::field<P, std::optional<Vec3d>>(schema::FieldType::vector3, "axis", &P::axis)
        .unit({schema::Dimension::none})
        .synonyms({"direction", "normal"})
        .doc("Direction of the axis, of any length; up when absent.")
        .example("axis 0 1 0");
}

bool inReach(Vec3d p);
// E0605 and E0604.
void reportOutOfReach(Span, Diagnostics&);
void reportNoArea(Span, Diagnostics&, const std::string& what);

// Turns the y axis to `axis`, moves the origin to `center`. Requires axis != 0.
Transform uprightAt(Vec3d center, Vec3d axis);
// Whether an axis, if there is one, has a direction; false after an error.
bool checkAxis(const std::optional<Vec3d>&, const ShapeContext&);

// A mesh whose outer side stays outside under mirrors. Null after an error located at `span`.
std::unique_ptr<const Shape> placeMesh(MeshData, const Transform& place, Span, Diagnostics&);

// Calls make(map) for a shape that any map but a flat one can place; null after an error: the map flattens the shape or
// moves it too far away.
std::unique_ptr<const Shape> placeParametric(const Transform& map, const ShapeContext&,
                                             const std::function<std::unique_ptr<const Shape>(const Transform&)>& make);

} // namespace abbe
