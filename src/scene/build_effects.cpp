// What a scene needs simulated, who asked for it, and what the scene forbids.
#include "scene/scene_builder.h"
#include "schema/suggest.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

namespace {

// Physics that no scene can ask for yet: forbidding it holds, and says so to who reads the scene.
constexpr std::string_view kNeverSimulated[] = {"fluorescence", "polarization", "diffraction"};

const EffectInfo* findEffect(std::string_view word) {
    const auto found = std::ranges::find(kEffectTable, word, &EffectInfo::word);
    return found == kEffectTable.end() ? nullptr : &*found;
}

void unknownEffect(const schema::TableCell& cell, Diagnostics& diagnostics) {
    std::vector<std::string_view> words(std::begin(kNeverSimulated), std::end(kNeverSimulated));
    for (const EffectInfo& info : kEffectTable) words.push_back(info.word);
    const std::string_view near = schema::nearest(cell.text, words);
    diagnostics.error("E0683", cell.span, fmt::format("no effect is called `{}`", cell.text), "in `forbid`").help =
        near.empty() ? fmt::format("effects are {}", fmt::join(words, ", ")) : schema::didYouMean(near);
}

} // namespace

void SceneBuilder::noteEffect(Effect effect, Span asker, std::string_view why) {
    built_->scene.effects |= effect;
    if (effect == Effect::motion) leavesOut({SwitchedEffect::motion}, asker); // noted here, whatever moves
    auto& reasons = built_->scene.reasons;
    const bool known = std::ranges::any_of(
        reasons, [&](const EffectReason& r) { return r.effect == effect && r.asker == asker && r.why == why; });
    if (!known) reasons.push_back({effect, asker, std::string(why)});
}

void SceneBuilder::noteEffects() {
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
    for (const Span span : lightTextures_) noteEffect(Effect::textures, span, "its light follows a texture");
    for (const auto& [index, span] : materialAskers_) {
        if (!usedMaterials_.contains(index)) continue; // what no shape shows asks for nothing
        Effects needs = materials_[index]->needs();
        if (materials_[index]->usesTextures()) needs |= Effect::textures;
        built_->scene.effects |= needs;
        for (const Note& note : kMaterialNotes)
            if (needs.has(note.effect)) noteEffect(note.effect, span, note.why);
        if (materials_[index]->mayBeOpen()) noteEffect(Effect::interfaces, span, "light goes through its openings");
    }
}

void SceneBuilder::noteShape(const LoadedShape& shape) {
    const Definition& d = *shape.definition;
    if (shape.deforms) noteEffect(Effect::motion, d.span, "it changes its shape while the shutter is open");
    if (shape.strands > 0) noteEffect(Effect::curves, d.span, "it is made of curves");
    if (d.type->name != "subdivision") return;
    noteEffect(Effect::subdivision, d.span, "its surface is the limit of a cage");
    for (const schema::Node& property : d.properties)
        if (property.name() == "displacement")
            noteEffect(Effect::displacement, property.headSpan(), "a map moves its surface");
}

// Where this build lacks an effect, as those that measure what it costs do.
void SceneBuilder::checkCompiled() {
    for (const EffectReason& reason : built_->scene.reasons) {
        if (!kLoopEffects.has(reason.effect) || isCompiled(reason.effect)) continue;
        diagnostics_
            .error("E0685", reason.asker, fmt::format("this build has no {}", infoOf(reason.effect).title), reason.why)
            .help = "build without the CMake option ABBE_WITHOUT";
    }
}

// At the line that needs what is forbidden: there it can be mended.
void SceneBuilder::checkForbidden() {
    for (const schema::TableRow& row : built_->render.forbid.rows) {
        const EffectInfo* const info = findEffect(row.cells[0].text);
        if (!info && std::ranges::find(kNeverSimulated, row.cells[0].text) == std::end(kNeverSimulated)) {
            unknownEffect(row.cells[0], diagnostics_);
        } else if (row.cells.size() > 1) {
            diagnostics_.error("E0309", row.cells[1].span, "a row of `forbid` is one word", "is one too many").help =
                fmt::format("for example `forbid {{ {}; motion }}`", row.cells[0].text);
        }
        if (!info) continue;
        for (const EffectReason& reason : built_->scene.reasons) {
            if (reason.effect != info->effect) continue;
            Diagnostic& d = diagnostics_.error("E0684", reason.asker.valid() ? reason.asker : row.span,
                                               fmt::format("this scene forbids {}", info->title), reason.why);
            if (reason.asker.valid()) d.related.push_back({row.span, "forbidden here"});
            d.help = fmt::format("leave it out, or take `{}` out of `forbid`", info->word);
        }
    }
}

} // namespace abbe
