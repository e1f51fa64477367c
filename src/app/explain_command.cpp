#include "app/command_line.h"
#include "app/explain_effects.h"
#include "app/light_path_text.h"
#include "app/options.h"
#include "base/diagnostic.h"
#include "caustics/light_tracing/light_path_planner.h"
#include "film/pixel_film.h"
#include "parser/presets.h"
#include "rendering/path_tracer.h"
#include "rendering/render_params.h"
#include "scene/registry.h"
#include "schema/describe.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace abbe {

namespace {

// A word of the language is meant even if there is a file of that name.
bool looksLikeFile(const std::string& topic) {
    std::error_code error;
    if (topic.ends_with(".scene") || topic.find('/') != std::string::npos) return true;
    return std::filesystem::is_regular_file(topic, error) && !schema::explain(makeTypeTable(), topic).found;
}

bool hasFrame(const BuildOptions& b) { return !b.camera.empty() || b.size || b.seed || b.pilot; }

// Decided by a look at the scene if need be, which takes its geometry. Undecided if that is at fault.
LightPathFindings lightPathsOf(const LoadedScene& loaded, const BuiltScene& described, const BuildOptions& build) {
    RenderSettings settings = renderSettings(described.render);
    settings.pilot = build.pilot.value_or(RenderSettings::kPilotByWork);
    LightPathFindings found;
    found.verdict = lightPathVerdict(described.scene, settings.technique);
    if (found.verdict != LightPathVerdict::undecided) return found;
    Diagnostics faults; // those of the scene's text have been told
    const BuiltScene built = buildScene(loaded.tree, loaded.types, build, faults);
    if (faults.hasErrors()) return found;
    const FilmSettings film = filmSettings(built.film);
    const PixelFilm like({0, 0, 1, 1}, PixelFilter(film.filter, film.filterRadius),
                         static_cast<int>(built.render.replicates));
    return makePathTracer(built.scene.effects)->findLightPaths(built.scene, like, settings);
}

ExitCode explainScene(const ExplainOptions& options, const CommonOptions& common) {
    const auto loaded = loadScene({options.topic, options.defines});
    BuildOptions build = options.build;
    build.geometry = false;
    BuiltScene built;
    if (loaded->readable) built = buildScene(loaded->tree, loaded->types, build, loaded->diagnostics);
    common.console.report(loaded->diagnostics, loaded->sources);
    if (loaded->exitCode() != ExitCode::done) return loaded->exitCode();
    const LightPathFindings found = lightPathsOf(*loaded, built, options.build);
    common.console.data(common.json
                            ? effectsJson(*loaded, built).set("light_paths", lightPathJson(found)).text(true) + "\n"
                            : effectsText(*loaded, built) + lightPathText(found));
    return ExitCode::done;
}

// Where a word is explained that is a command, or nearly the name of one and nothing else.
std::string commandHint(const std::string& topic, bool found) {
    if (isCommand(topic)) return fmt::format("`{0}` is a command: `abbe help {0}`", topic);
    const std::string near = found ? std::string() : commandSuggestion(topic);
    return near.empty() ? near : fmt::format("the command `{0}` is explained by `abbe help {0}`", near);
}

ExitCode explainWords(const std::string& topic, const Console& console) {
    schema::TypeTable types = makeTypeTable();
    SourceMap sources;
    Diagnostics diagnostics;
    addPresets(types, sources, diagnostics);
    if (topic.empty()) {
        console.data(schema::explainLanguage(types));
        return ExitCode::done;
    }
    const schema::Explanation explanation = schema::explain(types, topic);
    const std::string hint = commandHint(topic, explanation.found);
    if (explanation.found) {
        console.data(hint.empty() ? explanation.text : explanation.text + "\n" + hint + "\n");
        return ExitCode::done;
    }
    if (!isCommand(topic)) console.lines(std::string_view(explanation.text).substr(0, explanation.text.size() - 1));
    if (!hint.empty()) console.line(hint);
    return ExitCode::faulty;
}

} // namespace

ExitCode run(const ExplainOptions& options, const CommonOptions& common) {
    const bool scene = looksLikeFile(options.topic);
    if (!scene && hasFrame(options.build)) {
        common.console.line(
            "`--camera`, `--size`, `--seed` and `--pilot` are for a scene: `abbe explain x.scene --camera NAME`");
        return ExitCode::usage;
    }
    if (options.effects && options.topic.empty()) {
        common.console.data(allEffectsText());
        return ExitCode::done;
    }
    if (options.effects || scene) return explainScene(options, common);
    return explainWords(options.topic, common.console);
}

} // namespace abbe
