#include "scene/material_modifiers.h"

namespace abbe {

using namespace schema;

namespace {

using D = MaterialModifiers;

FieldInfo opacityField() {
    return field<D, TexturedNumber>(FieldType::number, "opacity", &D::opacity)
        .unit({Dimension::none, Dimension::fraction})
        .range(0, 1)
        .byDefault("1")
        .synonyms({"alpha", "cutout", "cutout_opacity", "geometry_opacity", "transparency", "presence"})
        .doc("Share of the light that meets the surface; the rest goes straight on. A texture cuts holes.")
        .example("opacity 0.7");
}

FieldInfo normalField() {
    return field<D, std::optional<WeightedReference>>(FieldType::weighted, "normal", &D::normal)
        .to(Kind::texture)
        .key({"strength", {}, "Factor of the slopes; 1 when absent."})
        .synonyms({"normal-map", "normalmap", "normal_map", "geometry_normal"})
        .doc("Normals in tangent space, 0 … 1 for -1 … 1: x along the texture's u, y along v, z outwards.")
        .example("normal image \"dents.png\" space=data strength=0.5");
}

FieldInfo bumpField() {
    return field<D, std::optional<Quantity>>(FieldType::quantity, "bump", &D::bump)
        .unit({Dimension::length})
        .range(-1e9, 1e9)
        .synonyms({"bump-map", "bumpmap", "height"})
        .doc("Shades the surface as if it were raised by the length times the map; its outline stays.")
        .example("bump 2 mm { map noise { scale 1 cm } }")
        .block({field<D, Reference>(FieldType::reference, "map", &D::bumpMap)
                    .to(Kind::texture)
                    .synonyms({"texture", "image"})
                    .doc("Name of a texture, or one written in place; its first channel counts.")
                    .example("map noise { scale 1 cm }")});
}

FieldInfo priorityField() {
    return field<D, std::int64_t>(FieldType::integer, "priority", &D::priority)
        .range(-1000000, 1000000)
        .byDefault("0")
        .synonyms({"nested_priority", "dielectric_priority", "nesting"})
        .doc("Where dielectrics overlap, the one of the highest priority fills the space.")
        .example("priority 2");
}

void find(FieldInfo& field, D& (*of)(void*)) {
    field.store = [inner = std::move(field.store), of](void* params, const BoundValue& value) {
        inner(&of(params), value);
    };
    for (FieldInfo& part : field.block) find(part, of);
}

} // namespace

std::vector<FieldInfo> modifierFields(MaterialModifiers& (*of)(void* params)) {
    std::vector<FieldInfo> fields = {opacityField(), normalField(), bumpField(), priorityField()};
    for (FieldInfo& field : fields) find(field, of);
    return fields;
}

} // namespace abbe
