#include "app/explain_effects.h"

#include <fmt/format.h>

namespace abbe {

namespace {

// Physics that this version does not have, whatever the scene says.
struct Limit {
    const char* name;
    const char* why;
};
constexpr Limit kLimits[] = {
    {"fluorescence", "light leaves a surface at the wavelength at which it arrived"},
    {"polarization", "all light counts as unpolarised, also after reflection"},
    {"diffraction", "geometrical optics; light interferes in thin films alone"},
};

std::string_view firstLine(const LoadedScene& loaded, Span span) {
    const std::string_view text = loaded.sources.text(span);
    return text.substr(0, text.find('\n'));
}

// "room.scene:12:3  `material prism dielectric`"
std::string place(const LoadedScene& loaded, Span span) {
    if (!span.valid()) return "the scene as a whole";
    const LineColumn at = loaded.sources.lineColumn(span.file, span.begin);
    return fmt::format("{}:{}:{}  `{}`", loaded.sources.path(span.file), at.line, at.column, firstLine(loaded, span));
}

Json reasonJson(const LoadedScene& loaded, const EffectReason& reason) {
    Json json = Json::object({{"why", reason.why}});
    if (!reason.asker.valid()) return json;
    const LineColumn at = loaded.sources.lineColumn(reason.asker.file, reason.asker.begin);
    json.set("file", std::string(loaded.sources.path(reason.asker.file)));
    json.set("line", static_cast<std::int64_t>(at.line)).set("column", static_cast<std::int64_t>(at.column));
    json.set("text", std::string(firstLine(loaded, reason.asker)));
    return json;
}

std::string absentText(const BuiltScene& built) {
    std::string text;
    for (const EffectInfo& e : kEffectTable)
        if (!built.scene.effects.has(e.effect)) text += fmt::format("  {}: {}\n", e.title, e.absent);
    if (built.render.maxDepth > 0)
        text += fmt::format("  light after {} scattering events: `max-depth` of `render` cuts it off\n",
                            built.render.maxDepth);
    return text.empty() ? text : "Not simulated here:\n" + text;
}

} // namespace

std::string effectsText(const LoadedScene& loaded, const BuiltScene& built) {
    std::string text = "Effects of this scene:\n";
    for (const EffectInfo& e : kEffectTable) {
        if (!built.scene.effects.has(e.effect)) continue;
        text += fmt::format("  {}: on\n", e.title);
        for (const EffectReason& reason : built.scene.reasons)
            if (reason.effect == e.effect) text += fmt::format("    {}: {}\n", place(loaded, reason.asker), reason.why);
    }
    if (built.scene.effects.empty()) text += "  none beyond reflection and refraction at surfaces\n";
    text += fmt::format("Wavelengths of paths: {}\n",
                        built.scene.wavelengths.followsLights()
                            ? "drawn as the lights of the scene emit, because lines or narrow bands dominate"
                            : "drawn from the smooth density of the eye, because the light is smooth in wavelength");
    text += absentText(built);
    text += "Not simulated by this version:\n";
    for (const Limit& limit : kLimits) text += fmt::format("  {}: {}\n", limit.name, limit.why);
    return text;
}

Json effectsJson(const LoadedScene& loaded, const BuiltScene& built) {
    Json simulated = Json::list(), absent = Json::list(), unsupported = Json::list();
    for (const EffectInfo& e : kEffectTable) {
        Json entry = Json::object({{"effect", e.word}, {"title", e.title}});
        if (!built.scene.effects.has(e.effect)) {
            absent.push(std::move(entry.set("why", e.absent)));
            continue;
        }
        Json reasons = Json::list();
        for (const EffectReason& reason : built.scene.reasons)
            if (reason.effect == e.effect) reasons.push(reasonJson(loaded, reason));
        simulated.push(std::move(entry.set("asked_by", std::move(reasons))));
    }
    for (const Limit& limit : kLimits) unsupported.push(Json::object({{"effect", limit.name}, {"why", limit.why}}));
    return Json::object(
        {{"simulated", std::move(simulated)}, {"absent", std::move(absent)}, {"unsupported", std::move(unsupported)}});
}

std::string allEffectsText() {
    std::string text = "Effects that a scene may call for, by the words of `render { forbid { … } }`:\n";
    for (const EffectInfo& e : kEffectTable) text += fmt::format("  {:<16}{}\n", e.word, e.title);
    text += "Never simulated, so that to forbid them always holds:\n";
    for (const Limit& limit : kLimits) text += fmt::format("  {:<16}{}\n", limit.name, limit.why);
    return text;
}

} // namespace abbe
