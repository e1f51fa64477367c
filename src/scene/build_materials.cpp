// Materials, and what they wear.
#include "media/henyey_greenstein.h"
#include "media/homogeneous.h"
#include "scene/dressed_material.h"
#include "scene/filled_material.h"
#include "scene/material_parts.h"
#include "scene/registry.h"
#include "scene/scene_builder.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

std::uint32_t SceneBuilder::keepMaterial(std::unique_ptr<const Material> material, Span asker) {
    materials_.push_back(switchedAbsorption(std::move(material), asker));
    const auto index = static_cast<std::uint32_t>(materials_.size() - 1);
    materialAskers_.emplace_back(index, asker);
    return index;
}

// Parts are made on the way, so that meeting a material that is open is a cycle. One that is inline cannot be met
// again.
schema::Reference SceneBuilder::materialReference(const Definition& d) {
    const auto bindInto = binder(d, diagnostics_);
    if (!d.type) {
        bindInto(nullptr);
        return {};
    }
    if (std::ranges::find(openMaterials_, &d) != openMaterials_.end()) {
        diagnostics_.error("E0722", d.nameSpan, fmt::format("material `{}` contains itself", d.name),
                           "a part of itself");
        return {};
    }
    openMaterials_.push_back(&d);
    openAskers_.emplace_back();
    const auto bindSwitched = [&](void* params) {
        const bool sound = bindInto(params);
        if (sound) switchParameters(d, params);
        return sound;
    };
    MadeMaterial made = makeMaterial(d.type->name, bindSwitched, {materials_, d, diagnostics_});
    auto askers = std::move(openAskers_.back());
    openAskers_.pop_back();
    openMaterials_.pop_back();
    if (!made.material) return {};
    if (made.inside) made.material = translucent(std::move(made.material), *made.inside, d);
    auto material = dressed(std::move(made.material), made.dress, d);
    if (!material) return {};
    if (made.dress.normal) askers.push_back({made.dress.normal->reference.index, made.dress.normal->span});
    if (made.dress.bump) askers.push_back({made.dress.bumpMap.index, made.dress.bump->span});
    built_->scene.names[material.get()] = nameOf(d);
    const schema::Reference kept{keepMaterial(std::move(material), d.span)};
    if (!askers.empty()) textureAskers_.emplace(kept.index, std::move(askers));
    return kept;
}

// The surface of a translucent solid and what is inside.
std::unique_ptr<const Material> SceneBuilder::translucent(std::unique_ptr<const Material> surface,
                                                          const SubsurfaceInside& inside, const Definition& d) {
    MediumOptics optics;
    optics.extinction = inside.extinction.get();
    optics.albedo = inside.albedo.get();
    optics.phase = std::make_shared<HenyeyGreenstein>(inside.anisotropy);
    optics.own = {inside.extinction, inside.albedo};
    auto filling = std::make_unique<HomogeneousMedium>(std::move(optics));
    evenMedia_.push_back(filling.get());
    const std::uint32_t medium = keepMedium(std::move(filling), d);
    if (leavesOut({SwitchedEffect::medium, nameOf(d)}, d.span)) return surface;
    const Material& inner = *undressed_.emplace_back(std::move(surface));
    return std::make_unique<FilledMaterial>(inner, *media_[medium]);
}

bool SceneBuilder::checkDress(const Material& material, const MaterialDress& dress, const Definition& d) {
    if (dress.bump && !dress.bumpMap.valid()) {
        diagnostics_.error("E0207", dress.bump->span, "`bump` needs a `map`", "is missing here").help =
            "for example `bump 2 mm { map noise { scale 1 cm } }`";
        return false;
    }
    if (dress.priority == 0 || material.ior()) return true;
    diagnostics_
        .error("E0721", placeOf(d, "priority"), fmt::format("a `{}` has no refractive index", d.type->name),
               "there is nothing to nest")
        .help = "`priority` orders dielectrics whose shapes overlap; leave it out here";
    return false;
}

// The textures of the maps, ready to be asked; nothing after an error.
std::optional<std::pair<NormalMap, BumpMap>> SceneBuilder::mapsOf(const MaterialDress& dress) {
    NormalMap normal;
    BumpMap bump;
    if (dress.normal) {
        const Span span = dress.normal->span;
        normal = {textureFor(dress.normal->reference, TextureUse::number, span),
                  static_cast<float>(dress.normal->weight)};
        if (!normal.texture) return std::nullopt;
        if (normal.texture->channels() < 3) {
            diagnostics_.error("E0720", span, "a normal map has three channels", "this texture has one").help =
                "heights belong to `bump`: `bump 2 mm { map … }`";
            return std::nullopt;
        }
    }
    if (dress.bump) {
        bump = {textureFor(dress.bumpMap, TextureUse::heights, dress.bump->span),
                static_cast<float>(dress.bump->value)};
        if (!bump.texture) return std::nullopt;
    }
    return std::pair(normal, bump);
}

std::unique_ptr<const Material> SceneBuilder::dressed(std::unique_ptr<const Material> material,
                                                      const MaterialDress& dress, const Definition& d) {
    if (!checkDress(*material, dress, d)) return nullptr;
    auto maps = mapsOf(dress);
    if (!maps) return nullptr;
    if ((dress.normal || dress.bump) && leavesOut({SwitchedEffect::bumps}, d.span)) maps.emplace();
    const DressedMaterial::Dress wear{NumberInput(dress.opacity, 0, 1), maps->first, maps->second,
                                      static_cast<int>(dress.priority)};
    if (wear.opacity.is(1) && !wear.normal.texture && !wear.bump.texture && wear.priority == 0) return material;
    const Material& inner = *undressed_.emplace_back(std::move(material));
    return std::make_unique<DressedMaterial>(inner, wear);
}

} // namespace abbe
