// Fields that several types of shapes have.
#pragma once

#include "scene/shape_types.h"

namespace abbe {

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

template <typename P> schema::FieldInfo attributeField() {
    using namespace schema;
    return field<P, std::vector<NamedNumbers>>(FieldType::namedNumbers, "attribute", &P::attributes)
        .synonyms({"primvar", "vertex-attribute", "attributes", "colors"})
        .doc("A name and a number, or a colour of three, for each of `points`: what the texture `attribute` shows.")
        .example("attribute \"wear\" 0 0.5 1 0.2");
}

template <typename P> schema::FieldInfo centerField(std::string_view what) {
    return schema::field<P, Vec3d>(schema::FieldType::vector3, "center", &P::center)
        .unit({schema::Dimension::length})
        .byDefault("0 0 0")
        .synonyms({"centre", "position", "origin"})
        .doc(what)
        .example("center 0 0.5 0");
}

} // namespace abbe
