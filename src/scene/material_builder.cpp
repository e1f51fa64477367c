// Materials, and what they made.
#include "scene/material_builder.h"

#include "materials/diffuse.h"
#include "media/homogeneous.h"
#include "media/phase_functions.h"
#include "scene/registry.h"
#include "scene/wrapped_materials.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

std::uint32_t MaterialBuilder::keep(std::unique_ptr<const Material> material, Span where) {
    materials_.push_back(withoutAbsorption(std::move(material), where));
    const auto index = static_cast<std::uint32_t>(materials_.size() - 1);
    places_.emplace_back(index, where);
    return index;
}

// Parts are made on the way, so that meeting a material that is open is a cycle. One that is inline cannot be met
// again.
schema::Reference MaterialBuilder::reference(const Definition& d) {
    const auto bindInto = context_.binder(d, context_.diagnostics);
    if (std::ranges::find(open_, &d) != open_.end()) {
        if (d.type) // else an error has been reported
            context_.diagnostics.error("E0722", d.nameSpan, fmt::format("material `{}` contains itself", d.name),
                                       "a part of itself");
        return {};
    }
    open_.push_back(&d);
    if (!d.type) {
        bindInto(nullptr);
        open_.pop_back();
        return {};
    }
    textures_.beginMaterial();
    MadeMaterial made = makerOf<MakeMaterial>(*d.type)(bindInto, {context_, d, materials_});
    auto uses = textures_.endMaterial();
    open_.pop_back();
    if (!made.material) return {};
    if (made.inside) made.material = translucent(std::move(made.material), *made.inside, d);
    auto material = modified(std::move(made.material), made.modifiers, d);
    if (!material) return {};
    if (made.modifiers.normal) uses.push_back({made.modifiers.normal->reference.index, made.modifiers.normal->span});
    if (made.modifiers.bump) uses.push_back({made.modifiers.bumpMap.index, made.modifiers.bump->span});
    context_.built.scene.names[material.get()] = context_.nameOf(d);
    const schema::Reference kept{keep(std::move(material), d.span)};
    textures_.keepUses(kept.index, std::move(uses));
    return kept;
}

// The surface of a translucent solid and what is inside.
std::unique_ptr<const Material> MaterialBuilder::translucent(std::unique_ptr<const Material> surface,
                                                             const SubsurfaceInside& inside, const Definition& d) {
    MediumOptics optics;
    optics.extinction = inside.extinction.get();
    optics.albedo = inside.albedo.get();
    optics.phase = std::make_shared<HenyeyGreenstein>(inside.anisotropy);
    optics.own = {inside.extinction, inside.albedo};
    auto filling = std::make_unique<HomogeneousMedium>(std::move(optics));
    const schema::Reference medium{media_.keep(std::move(filling), d)};
    if (context_.leavesOut({SwitchedEffect::medium, context_.nameOf(d)}, d.span)) return surface;
    const Material& inner = *inner_.emplace_back(std::move(surface));
    return std::make_unique<FilledMaterial>(inner, media_[medium]);
}

bool MaterialBuilder::checkModifiers(const Material& material, const MaterialModifiers& modifiers,
                                     const Definition& d) {
    if (modifiers.bump && !modifiers.bumpMap.valid()) {
        context_.diagnostics.error("E0207", modifiers.bump->span, "`bump` needs a `map`", "is missing here").help =
            "for example `bump 2 mm { map noise { scale 1 cm } }`";
        return false;
    }
    if (modifiers.priority == 0 || material.ior()) return true;
    context_.diagnostics
        .error("E0721", placeOf(d, "priority"), fmt::format("a `{}` has no refractive index", d.type->name),
               "there is nothing to nest")
        .help = "`priority` orders dielectrics whose shapes overlap; leave it out here";
    return false;
}

// The textures of the maps, ready to be asked; nothing after an error.
std::optional<std::pair<NormalMap, BumpMap>> MaterialBuilder::mapsOf(const MaterialModifiers& modifiers) {
    NormalMap normal;
    BumpMap bump;
    if (modifiers.normal) {
        const Span span = modifiers.normal->span;
        normal = {textures_.textureFor(modifiers.normal->reference, TextureUse::number, span),
                  static_cast<float>(modifiers.normal->weight)};
        if (!normal.texture) return std::nullopt;
        if (normal.texture->channels() < 3) {
            context_.diagnostics.error("E0720", span, "a normal map has three channels", "this texture has one").help =
                "heights belong to `bump`: `bump 2 mm { map … }`";
            return std::nullopt;
        }
    }
    if (modifiers.bump) {
        bump = {textures_.textureFor(modifiers.bumpMap, TextureUse::heights, modifiers.bump->span),
                static_cast<float>(modifiers.bump->value)};
        if (!bump.texture) return std::nullopt;
    }
    return std::pair(normal, bump);
}

std::unique_ptr<const Material> MaterialBuilder::modified(std::unique_ptr<const Material> material,
                                                          const MaterialModifiers& modifiers, const Definition& d) {
    if (!checkModifiers(*material, modifiers, d)) return nullptr;
    auto maps = mapsOf(modifiers);
    if (!maps) return nullptr;
    if ((modifiers.normal || modifiers.bump) && context_.leavesOut({SwitchedEffect::bumps}, d.span)) maps.emplace();
    const ModifiedMaterial::Modifiers made{NumberInput(modifiers.opacity, 0, 1), maps->first, maps->second,
                                           static_cast<int>(modifiers.priority)};
    if (made.opacity.is(1) && !made.normal.texture && !made.bump.texture && made.priority == 0) return material;
    const Material& inner = *inner_.emplace_back(std::move(material));
    return std::make_unique<ModifiedMaterial>(inner, made);
}

std::unique_ptr<const Material> MaterialBuilder::withoutAbsorption(std::unique_ptr<const Material> material,
                                                                   Span where) {
    if (!material->absorption() || !context_.leavesOut({SwitchedEffect::absorption}, where)) return material;
    return std::make_unique<ClearMaterial>(*inner_.emplace_back(std::move(material)));
}

std::unique_ptr<const Material> makePlainMaterial(const Curve* reflectance) {
    DiffuseParams params;
    params.reflectance.curve = reflectance;
    return makeDiffuse(params);
}

const Material* MaterialBuilder::plain(double reflectance) {
    auto& index = plain_[reflectance];
    if (!index) {
        index = static_cast<std::uint32_t>(materials_.size());
        materials_.push_back(makePlainMaterial(context_.curves.constant(reflectance)));
    }
    return materials_[*index].get();
}

// The surface and what it holds, as one material.
const Material* MaterialBuilder::filled(const Material* surface, const ShapeParams& params) {
    if (!params.interior.valid()) {
        if (surface->interior()) media_.noteInterior(*surface->interior());
        return surface;
    }
    const Medium& medium = media_[params.interior];
    if (context_.leavesOut({SwitchedEffect::medium, context_.built.scene.mediumUses[medium.number].name},
                           media_.spanOf(medium)))
        return surface;
    auto& index = filled_[{surface, &medium}];
    if (!index) {
        index = static_cast<std::uint32_t>(materials_.size());
        materials_.push_back(std::make_unique<FilledMaterial>(*surface, medium));
        context_.built.scene.names[materials_.back().get()] = context_.built.scene.names[surface];
        used_.insert(*index);
        media_.noteInterior(medium);
    }
    return materials_[*index].get();
}

const Material* MaterialBuilder::ofShape(const ShapeParams& params) {
    if (!params.material.valid()) return filled(plain(0.5), params);
    used_.insert(params.material.index);
    return filled(materials_[params.material.index].get(), params);
}

const Material* MaterialBuilder::ofGroup(const schema::GroupReference& group, const ShapeParams& params) {
    used_.insert(group.reference.index);
    return filled(materials_[group.reference.index].get(), params);
}

bool MaterialBuilder::holdsMedium(const ShapeParams& params) const {
    const auto filling = [this](schema::Reference m) { return m.valid() && materials_[m.index]->interior(); };
    return params.interior.valid() || filling(params.material) ||
           std::ranges::any_of(params.groupMaterials, [&](const auto& g) { return filling(g.reference); });
}

void MaterialBuilder::noteEffects() {
    struct Note {
        Effect effect;
        std::string_view why;
    };
    static constexpr Note kMaterialNotes[] = {
        {Effect::dispersion, "its refractive index varies with wavelength"},
        {Effect::textures, "it looks at a texture"},
        {Effect::absorption, "light is absorbed inside it"},
        {Effect::thinFilm, "a thin film covers it"},
        {Effect::bumps, "a map bends its normals"},
    };
    for (const auto& [index, span] : places_) {
        if (!used_.contains(index)) continue; // what no shape shows asks for nothing
        Effects needs = materials_[index]->needs();
        if (materials_[index]->usesTextures()) needs |= Effect::textures;
        context_.built.scene.effects |= needs;
        for (const Note& note : kMaterialNotes)
            if (needs.has(note.effect)) context_.noteEffect(note.effect, span, note.why);
        if (materials_[index]->mayBeOpen())
            context_.noteEffect(Effect::interfaces, span, "light goes through its openings");
    }
}

bool MaterialBuilder::boundaries() const {
    return std::ranges::any_of(
        used_, [&](std::uint32_t m) { return materials_[m]->isBoundary() || materials_[m]->mayBeOpen(); });
}

std::vector<std::unique_ptr<const Material>> MaterialBuilder::release() {
    for (auto& inner : inner_) materials_.push_back(std::move(inner));
    return std::move(materials_);
}

namespace {

// Boundaries are no surface to scatter at, and what emits would have to be a light.
bool canBePart(schema::Reference reference, std::string_view property, const MaterialContext& parts) {
    const Material& part = parts[reference];
    const bool boundary = part.isBoundary();
    if (!boundary && !(part.emission().luminance > 0)) return true;
    parts.diagnostics()
        .error("E0723", placeOf(parts.definition, property),
               boundary ? "a boundary cannot be a part of a material" : "a part of a material cannot emit",
               boundary ? "there is nothing that scatters" : "gives off light")
        .help = boundary ? "for a surface that lets light through, write `opacity`"
                         : "leave its emission out, or give the shape itself an `emission`";
    return false;
}

bool isOpaque(schema::Reference reference, std::string_view property, const MaterialContext& parts) {
    if (!hasInside(parts[reference])) return true;
    parts.diagnostics()
        .error("E0724", placeOf(parts.definition, property), fmt::format("`{}` must have no inside here", property),
               "light would enter the shape")
        .help = "take a material that is opaque, or thin";
    return false;
}

} // namespace

Span placeOf(const schema::Definition& d, std::string_view property) {
    for (const schema::Node& node : d.properties)
        if (node.name() == property) return node.headSpan();
    for (const schema::Key& key : d.keys)
        if (key.name == property) return key.nameSpan;
    return d.span;
}

std::unique_ptr<const Material> makeMixOf(const MixParams& params, const MaterialContext& parts) {
    if (!canBePart(params.first, "first", parts) || !canBePart(params.second, "second", parts)) return nullptr;
    const Material &first = parts[params.first], &second = parts[params.second];
    if (hasInside(first) && hasInside(second) && !sameInside(first, second)) {
        auto& d =
            parts.diagnostics().error("E0724", placeOf(parts.definition, "second"),
                                      "the parts of a mix fill the shape with different things", "this one differs");
        d.related.push_back({placeOf(parts.definition, "first"), "from this one"});
        d.help = "give both the same `ior`, `absorption` and interior; they may differ in roughness";
        return nullptr;
    }
    return makeMix(params, first, second);
}

std::unique_ptr<const Material> makeLayeredOf(const LayeredParams& params, const MaterialContext& parts) {
    if (!canBePart(params.base, "base", parts) || !isOpaque(params.base, "base", parts)) return nullptr;
    return makeLayered(params, parts[params.base], parts.scene.tables());
}

std::unique_ptr<const Material> makeSubsurfaceOf(const SubsurfaceParams& params, const MaterialContext& context) {
    return makeSubsurfaceSurface(params, context.scene.tables());
}

std::unique_ptr<const Material> makeTwoSidedOf(const TwoSidedParams& params, const MaterialContext& parts) {
    for (const auto& [reference, property] : {std::pair(params.front, "front"), std::pair(params.back, "back")})
        if (!canBePart(reference, property, parts) || !isOpaque(reference, property, parts)) return nullptr;
    return makeTwoSided(parts[params.front], parts[params.back]);
}

void leaveOutEffects(OpenPbrParams& p, const MaterialContext& context) {
    const auto leavesOut = [&](SwitchedEffect effect) {
        return context.scene.leavesOut({effect}, context.definition.span);
    };
    if (p.transmissionDispersionScale > 0 && leavesOut(SwitchedEffect::dispersion)) p.transmissionDispersionScale = 0;
    const bool filmed = p.thinFilmWeight.texture || p.thinFilmWeight.value > 0;
    if (filmed && p.thinFilmThickness > 0 && leavesOut(SwitchedEffect::thinFilm)) p.thinFilmWeight = {};
}

} // namespace abbe
