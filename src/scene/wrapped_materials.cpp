#include "scene/wrapped_materials.h"

#include "math/frame.h"
#include "render/surface_input.h"
#include "scene/material_builder.h"

namespace abbe {

namespace {

// For Bsdfs that tell directions about the normal apart, x stays along the texture's u.
void turn(SurfaceHit& hit, Vec3 normal) {
    const bool known = lengthSquared(hit.dpdu) > 0;
    hit.shading = Frame::fromNormalTangent(normal, known ? hit.dpdu : hit.shading.x);
}

} // namespace

// n' ∝ n - ∇h, with the gradient of the height along the surface [Mikkelsen2010, eq. 3; Blinn1978]: by uv with the
// vectors dual to dp/du and dp/dv, by position with the gradients of the local coordinates.
Vec3 bumpedNormal(const BumpMap& map, const SurfaceHit& hit) {
    const TextureWork work;
    const Vec3 n = hit.shading.z;
    const TextureJet j = map.texture->jet({Vec3d(hit.local), hit.uv, hit.uv}, 1);
    Vec3 gradient = hit.localX * j.byPosition[0].x + hit.localY * j.byPosition[1].x + hit.localZ * j.byPosition[2].x;
    const Vec3 dual = cross(hit.dpdv, n);
    const float area = dot(hit.dpdu, dual);
    if (square(area) > 1e-12f * lengthSquared(hit.dpdu) * lengthSquared(hit.dpdv))
        gradient = gradient + (dual * j.byUv[0].x + cross(n, hit.dpdu) * j.byUv[1].x) * (1 / area);
    const Vec3 bent = n - (gradient - n * dot(n, gradient)) * map.height;
    const float l2 = lengthSquared(bent);
    return l2 < kInfinity ? bent * (1 / std::sqrt(l2)) : n;
}

ModifiedMaterial::ModifiedMaterial(const Material& inner, const Modifiers& modifiers)
    : ForwardingMaterial(inner), modifiers_(modifiers) {
    const bool bent = modifiers.normal.texture || modifiers.bump.texture;
    if (!modifiers.opacity.is(1)) traits_.mayBeOpen = true;
    if (traits_.mayBeOpen) traits_.isOpaque = false;
    if (bent) traits_.bends = true;
    if (bent || modifiers.opacity.textured()) traits_.usesTextures = true;
    if (traits_.mayBeOpen || modifiers.priority != 0) traits_.needs |= Effect::interfaces;
    if (bent) traits_.needs |= Effect::bumps;
    inside_.priority = modifiers.priority;
}

void ModifiedMaterial::bend(SurfaceHit& hit) const noexcept {
    if (modifiers_.normal.texture) turn(hit, mappedNormal(modifiers_.normal, hit));
    if (modifiers_.bump.texture) turn(hit, bumpedNormal(modifiers_.bump, hit));
    if (modifiers_.normal.texture || modifiers_.bump.texture)
        turn(hit, consistentNormal(hit.ng, hit.shading.z, -hit.arrival));
    inner_.bend(hit); // which may turn the tangent
}

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
