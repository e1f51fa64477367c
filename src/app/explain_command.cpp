#include "app/options.h"
#include "base/diagnostic_catalogue.h"
#include "parser/presets.h"
#include "scene/registry.h"
#include "schema/describe.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace abbe {

namespace {

struct EffectText {
    Effect effect;
    const char* name;
    const char* whyOff;
};
constexpr EffectText kEffects[] = {
    {Effect::absorption, "absorption inside media", "no dielectric has an absorption"},
    {Effect::media, "scattering in media", "no volume and no interior of a shape"},
    {Effect::textures, "footprints of paths", "no material looks at a texture"},
    {Effect::interfaces, "open and nested surfaces", "no surface is partly open, no dielectrics may overlap"},
    {Effect::dispersion, "dispersion", "no refractive index and no extinction varies with wavelength"},
};

// Physics that this version does not have, whatever the scene says.
struct Limit {
    const char* name;
    const char* why;
};
constexpr Limit kLimits[] = {
    {"fluorescence", "light leaves a surface at the wavelength at which it arrived"},
    {"polarisation", "all light counts as unpolarised, also after reflection"},
    {"diffraction", "geometrical optics; light interferes in thin films alone"},
};

// "room.scene:12:3  `material prism dielectric`"
std::string place(const LoadedScene& loaded, Span span) {
    if (!span.valid()) return "default";
    const LineColumn at = loaded.sources.lineColumn(span.file, span.begin);
    std::string_view text = loaded.sources.text(span);
    text = text.substr(0, text.find('\n'));
    return fmt::format("{}:{}:{}  `{}`", loaded.sources.path(span.file), at.line, at.column, text);
}

void explainEffects(const LoadedScene& loaded, const BuiltScene& built, std::string& text) {
    text += "Effects of this scene:\n";
    for (const EffectText& e : kEffects) {
        if (!built.scene.effects.has(e.effect)) continue;
        text += fmt::format("  {}: on\n", e.name);
        for (const EffectReason& reason : built.scene.reasons)
            if (reason.effect == e.effect) text += fmt::format("    {}: {}\n", place(loaded, reason.asker), reason.why);
    }
    if (built.scene.effects.empty()) text += "  none beyond reflection and refraction at surfaces\n";
    text += fmt::format("Wavelengths of paths: {}\n",
                        built.scene.wavelengths.followsLights()
                            ? "drawn as the lights of the scene emit, because lines or narrow bands dominate"
                            : "drawn from the smooth density of the eye, because the light is smooth in wavelength");
    std::string off;
    for (const EffectText& e : kEffects)
        if (!built.scene.effects.has(e.effect)) off += fmt::format("  {}: {}\n", e.name, e.whyOff);
    if (built.render.maxDepth > 0)
        off += fmt::format("  light after {} scattering events: `max-depth` of `render` cuts it off\n",
                           built.render.maxDepth);
    if (!off.empty()) text += "Not simulated here:\n" + off;
    text += "Not simulated by this version:\n";
    for (const Limit& limit : kLimits) text += fmt::format("  {}: {}\n", limit.name, limit.why);
}

bool looksLikeFile(const std::string& topic) {
    std::error_code error;
    return topic.ends_with(".scene") || topic.find('/') != std::string::npos ||
           std::filesystem::is_regular_file(topic, error);
}

ExitCode explainScene(const ExplainOptions& options, const CommonOptions& common) {
    const auto loaded = loadScene({options.topic, options.defines});
    BuildOptions build;
    build.geometry = false;
    BuiltScene built;
    if (loaded->readable) built = buildScene(loaded->tree, loaded->types, build, loaded->diagnostics);
    common.console.report(loaded->diagnostics, loaded->sources);
    if (loaded->exitCode() != ExitCode::done) return loaded->exitCode();
    std::string text;
    explainEffects(*loaded, built, text);
    common.console.data(text);
    return ExitCode::done;
}

} // namespace

ExitCode run(const ExplainOptions& options, const CommonOptions& common) {
    if (looksLikeFile(options.topic)) return explainScene(options, common);
    schema::TypeTable types = makeTypeTable();
    SourceMap sources;
    Diagnostics diagnostics;
    addPresets(types, sources, diagnostics);
    const schema::Explanation explanation = schema::explain(types, options.topic);
    if (explanation.found) {
        common.console.data(explanation.text);
        return ExitCode::done;
    }
    common.console.line(explanation.text);
    return ExitCode::faulty;
}

} // namespace abbe
