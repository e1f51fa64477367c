// What of a scene can be left out, and how it is.
#include "scene/effect_switches.h"

#include "materials/openpbr.h"
#include "scene/reduced.h"
#include "scene/scene_builder.h"

namespace abbe {

namespace {

constexpr double kHeliumLine = 587.6; // nm, the d line, to which indices of glasses refer

} // namespace

std::string_view wordOf(SwitchedEffect effect) {
    constexpr std::string_view words[] = {"dispersion", "absorption",   "motion",    "depth-of-field",
                                          "bumps",      "displacement", "thin-film", "volume"};
    return words[static_cast<std::size_t>(effect)];
}

// True if it is to be left out; notes who asked for it.
bool SceneBuilder::leavesOut(EffectSwitch effect, Span asker) {
    auto& askers = built_->askers;
    if (std::ranges::find(askers, effect, &EffectAsker::effect) == askers.end()) askers.push_back({effect, asker});
    return effect.effect == SwitchedEffect::medium ? options_.without.leavesOutMedium(effect.medium)
                                                   : options_.without.leavesOut(effect.effect);
}

const Curve* SceneBuilder::switchedIndex(const Curve* index, Span asker) {
    if (!index || index->isConstant() || !leavesOut({SwitchedEffect::dispersion}, asker)) return index;
    return curves_.constant(index->at(kHeliumLine));
}

std::unique_ptr<const Material> SceneBuilder::switchedAbsorption(std::unique_ptr<const Material> material, Span asker) {
    if (!material->absorption() || !leavesOut({SwitchedEffect::absorption}, asker)) return material;
    return std::make_unique<ClearMaterial>(*undressed_.emplace_back(std::move(material)));
}

// Before a material is made of its parameters.
void SceneBuilder::switchParameters(const Definition& d, void* params) {
    if (!d.type || d.type->name != "openpbr" || !params) return;
    auto& p = *static_cast<OpenPbrParams*>(params);
    if (p.transmissionDispersionScale > 0 && leavesOut({SwitchedEffect::dispersion}, d.span))
        p.transmissionDispersionScale = 0;
    const bool filmed = p.thinFilmWeight.texture || p.thinFilmWeight.value > 0;
    if (filmed && p.thinFilmThickness > 0 && leavesOut({SwitchedEffect::thinFilm}, d.span)) p.thinFilmWeight = {};
}

// Before anything is placed; the shutter of the scene is known.
void SceneBuilder::switchCamera(BuiltScene& built, const Definition& camera) {
    const bool centred = built.scene.camera->usesLens() && leavesOut({SwitchedEffect::depthOfField}, camera.span);
    const bool still = options_.without.leavesOut(SwitchedEffect::motion);
    if (still) built.shutter = {built.shutter.open + built.shutter.duration / 2, 0};
    if (centred || still)
        built.scene.camera = std::make_unique<HeldCamera>(std::move(built.scene.camera), centred, still);
}

} // namespace abbe
