// What a scene needs simulated, who asked for it, and what the scene forbids.
#include "scene/build_context.h"
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

std::string_view wordOf(SwitchedEffect effect) {
    constexpr std::string_view words[] = {"dispersion", "absorption",   "motion",    "depth-of-field",
                                          "bumps",      "displacement", "thin-film", "volume"};
    return words[static_cast<std::size_t>(effect)];
}

bool BuildContext::leavesOut(EffectSwitch effect, Span asker) {
    auto& askers = built.askers;
    if (std::ranges::find(askers, effect, &EffectAsker::effect) == askers.end()) askers.push_back({effect, asker});
    return effect.effect == SwitchedEffect::medium ? options.without.leavesOutMedium(effect.medium)
                                                   : options.without.leavesOut(effect.effect);
}

void BuildContext::noteEffect(Effect effect, Span asker, std::string_view why) {
    built.scene.effects |= effect;
    if (effect == Effect::motion) leavesOut({SwitchedEffect::motion}, asker); // noted here, whatever moves
    auto& reasons = built.scene.reasons;
    const bool known = std::ranges::any_of(
        reasons, [&](const EffectReason& r) { return r.effect == effect && r.asker == asker && r.why == why; });
    if (!known) reasons.push_back({effect, asker, std::string(why)});
}

// Where this build lacks an effect, as those that measure what it costs do.
void BuildContext::checkCompiled() {
    for (const EffectReason& reason : built.scene.reasons) {
        if (!kLoopEffects.has(reason.effect) || isCompiled(reason.effect)) continue;
        diagnostics
            .error("E0685", reason.asker, fmt::format("this build has no {}", infoOf(reason.effect).title), reason.why)
            .help = "build without the CMake option ABBE_WITHOUT";
    }
}

// At the line that needs what is forbidden: there it can be mended.
void BuildContext::checkForbidden() {
    for (const schema::TableRow& row : built.render.forbid.rows) {
        const EffectInfo* const info = findEffect(row.cells[0].text);
        if (!info && std::ranges::find(kNeverSimulated, row.cells[0].text) == std::end(kNeverSimulated)) {
            unknownEffect(row.cells[0], diagnostics);
        } else if (row.cells.size() > 1) {
            diagnostics.error("E0309", row.cells[1].span, "a row of `forbid` is one word", "is one too many").help =
                fmt::format("for example `forbid {{ {}; motion }}`", row.cells[0].text);
        }
        if (!info) continue;
        for (const EffectReason& reason : built.scene.reasons) {
            if (reason.effect != info->effect) continue;
            Diagnostic& d = diagnostics.error("E0684", reason.asker.valid() ? reason.asker : row.span,
                                              fmt::format("this scene forbids {}", info->title), reason.why);
            if (reason.asker.valid()) d.related.push_back({row.span, "forbidden here"});
            d.help = fmt::format("leave it out, or take `{}` out of `forbid`", info->word);
        }
    }
}

} // namespace abbe
