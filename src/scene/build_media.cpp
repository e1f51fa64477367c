// Phase functions, media that fill shapes, and volumes that stand by themselves.
#include "media/atmosphere.h"
#include "media/homogeneous.h"
#include "media/phase_types.h"
#include "scene/filled_material.h"
#include "scene/scene_builder.h"

#include <fmt/format.h>

namespace abbe {

using schema::Kind;

// Both are made once if they have a name.
schema::Reference SceneBuilder::phaseReference(const Definition& d) {
    const auto bindInto = [&](void* params) {
        const std::size_t before = diagnostics_.errorCount();
        schema::bind(d, tree_, types_, *this, params, diagnostics_);
        return diagnostics_.errorCount() == before;
    };
    if (!d.type) {
        bindInto(nullptr);
        return {};
    }
    auto phase = makePhase(d.type->name, bindInto);
    if (!phase) return {};
    phases_.push_back(std::move(phase));
    return {static_cast<std::uint32_t>(phases_.size() - 1)};
}

schema::Reference SceneBuilder::mediumReference(const Definition& d) {
    const auto params = bound<HomogeneousParams>(d);
    if (!params) return {};
    const auto optics = opticsOf(*params, d);
    if (!optics) return {};
    mediumSpans_.resize(media_.size());
    media_.push_back(std::make_unique<HomogeneousMedium>(*optics));
    mediumSpans_.push_back(d.span);
    return {static_cast<std::uint32_t>(media_.size() - 1)};
}

std::optional<MediumOptics> SceneBuilder::opticsOf(const MediumParams& params, const Definition& d) {
    if (const auto fault = findContradiction(params); !fault.empty()) {
        diagnostics_.error("E0640", d.span, "a medium has extinction and albedo, or scattering and absorption",
                           std::string(fault));
        return std::nullopt;
    }
    return makeOptics(params, params.phase.valid() ? phases_[params.phase.index] : nullptr, curves_.constant(0),
                      curves_.constant(1));
}

void SceneBuilder::placeVolume(const Definition& d, const Transform& toRender) {
    if (!d.type) {
        bound<MediumParams>(d);
        return;
    }
    const auto params = bound<AtmosphereParams>(d);
    if (!params) return;
    const auto optics = opticsOf(*params, d);
    if (!optics) return;
    const Vec3d up = tree_.header.zUp ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0};
    const double ground = dot(toRender.point(up * params->ground), up);
    media_.push_back(std::make_unique<Atmosphere>(*optics, Vec3(up), ground, params->scaleHeight));
    openMedia_.push_back({media_.back().get(), d.span});
}

// The surface and what it holds, as one material.
const Material* SceneBuilder::filled(const Material* surface, const ShapeParams& params) {
    if (!params.interior.valid()) return surface;
    const Medium& medium = *media_[params.interior.index];
    auto& index = filled_[{surface, &medium}];
    if (!index) {
        index = static_cast<std::uint32_t>(materials_.size());
        materials_.push_back(std::make_unique<FilledMaterial>(*surface, medium));
        usedMaterials_.insert(*index);
        interiorAskers_.emplace_back(&medium, mediumSpans_[params.interior.index]);
    }
    return materials_[*index].get();
}

void SceneBuilder::noteMedia(Scene& scene) {
    const auto note = [&](const Medium& medium, Span span, std::string_view what) {
        scene.effects |= medium.needs();
        scene.reasons.push_back({Effect::media, span, fmt::format("light is scattered in {}", what)});
        if (medium.needs().has(Effect::dispersion))
            scene.reasons.push_back({Effect::dispersion, span, "its extinction varies with wavelength"});
    };
    for (const auto& [medium, span] : interiorAskers_) note(*medium, span, "the shapes that this medium fills");
    for (const auto& [medium, span] : openMedia_) {
        note(*medium, span, "this volume");
        scene.openMedia.push_back(medium);
    }
    scene.interiors = !interiorAskers_.empty();
    for (const std::uint32_t index : usedMaterials_) scene.boundaries |= materials_[index]->isBoundary();
    scene.media = std::move(media_);
}

} // namespace abbe
