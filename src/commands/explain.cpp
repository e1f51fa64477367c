#include "app/json.h"
#include "app/load.h"
#include "base/diagnostic.h"
#include "command_line/command.h"
#include "command_line/parser.h"
#include "command_line/shared_arguments.h"
#include "commands/command_table.h"
#include "film/pixel_film.h"
#include "parser/presets.h"
#include "rendering/path_tracer.h"
#include "rendering/render_params.h"
#include "reports/render_text.h"
#include "scene/build.h"
#include "scene/registry.h"
#include "schema/describe.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <string>

namespace abbe {

const char* const kExplainHelp = R"(Explains a scene, a property, a type, a unit or a diagnostic.

Examples:
  abbe explain                                 how scenes are written, and what there is
  abbe explain film                            what a kind takes
  abbe explain room.scene --effects            what it needs simulated and which line asks, and what is not simulated
  abbe explain pool.scene --camera diver       also which light paths a render with these options will take
  abbe explain camera.lens
  abbe explain dielectric
  abbe explain E0310
  abbe explain unit nits)";

void addArguments(Arguments& a, ExplainOptions& o) {
    const auto readTopic = [&o](const std::vector<std::string>& words) {
        o.topic = fmt::format("{}", fmt::join(words, " "));
        return std::string();
    };
    a.argument("topic", readTopic, "Scene file, or words of the language; without any: how scenes are written");
    a.flag("--effects", &o.effects, "What a scene needs simulated; without one: all effects");
    addFrame(a, o.build);
    addDefines(a, o.defines);
    addLayers(a, o.layers);
    addMoment(a, o.frame);
    addJson(a);
}

namespace {

// --- effects: which ones a scene calls for, and who asked for them

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
    if (!reason.place.valid()) return json;
    const LineColumn at = loaded.sources.lineColumn(reason.place.file, reason.place.begin);
    json.set("file", std::string(loaded.sources.path(reason.place.file)));
    json.set("line", static_cast<std::int64_t>(at.line)).set("column", static_cast<std::int64_t>(at.column));
    json.set("text", std::string(firstLine(loaded, reason.place)));
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

// For people: what is simulated with the lines that asked for it, and what is not with the reason.
std::string effectsText(const LoadedScene& loaded, const BuiltScene& built) {
    std::string text = "Effects of this scene:\n";
    for (const EffectInfo& e : kEffectTable) {
        if (!built.scene.effects.has(e.effect)) continue;
        text += fmt::format("  {}: on\n", e.title);
        for (const EffectReason& reason : built.scene.reasons)
            if (reason.effect == e.effect) text += fmt::format("    {}: {}\n", place(loaded, reason.place), reason.why);
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

// The same for programs: {"simulated": [...], "absent": [...], "unsupported": [...]}.
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

// All effects that there are, by the words of `forbid`.
std::string allEffectsText() {
    std::string text = "Effects that a scene may call for, by the words of `render { forbid { … } }`:\n";
    for (const EffectInfo& e : kEffectTable) text += fmt::format("  {:<16}{}\n", e.word, e.title);
    text += "Never simulated, so that to forbid them always holds:\n";
    for (const Limit& limit : kLimits) text += fmt::format("  {:<16}{}\n", limit.name, limit.why);
    return text;
}

// --- topics

// A word of the language is meant even if there is a file of that name.
bool looksLikeFile(const std::string& topic) {
    std::error_code error;
    if (topic.ends_with(".scene") || topic.find('/') != std::string::npos) return true;
    return std::filesystem::is_regular_file(topic, error) && !schema::explain(makeTypeTable(), topic).found;
}

bool hasFrame(const BuildOptions& b) { return !b.camera.empty() || b.size || b.seed || b.pilot; }

// Decided by a look at the scene if need be, which takes its geometry. Undecided if that is at fault.
CausticFindings causticsOf(const LoadedScene& loaded, const BuiltScene& described, const BuildOptions& build) {
    RenderSettings settings = renderSettings(described.render);
    settings.pilot = build.pilot.value_or(RenderSettings::kPilotByWork);
    CausticFindings found;
    auto& verdict = found.of<LightPathFindings>().verdict;
    verdict = lightPathVerdict(described.scene, settings.technique);
    if (verdict != LightPathVerdict::undecided) return found;
    Diagnostics faults; // those of the scene's text have been reported
    const BuiltScene built = buildScene(loaded.tree, loaded.types, build, faults);
    if (faults.hasErrors()) return found;
    const FilmSettings film = filmSettings(built.film);
    const PixelFilm like({0, 0, 1, 1}, PixelFilter(film.filter, film.filterRadius),
                         static_cast<int>(built.render.replicates));
    return makePathTracer(built.scene.effects)->findCaustics(built.scene, like, settings);
}

ExitCode explainScene(const ExplainOptions& options, const CommonOptions& common) {
    const auto loaded = loadScene({options.topic, options.defines, false, options.frame, options.layers});
    BuildOptions build = options.build;
    build.geometry = false;
    BuiltScene built;
    if (loaded->readable) built = buildScene(loaded->tree, loaded->types, build, loaded->diagnostics);
    common.console.report(loaded->diagnostics, loaded->sources);
    if (loaded->exitCode() != ExitCode::done) return loaded->exitCode();
    const CausticFindings found = causticsOf(*loaded, built, options.build);
    common.console.data(common.json
                            ? effectsJson(*loaded, built).set("light_paths", lightPathJson(found)).text(true) + "\n"
                            : effectsText(*loaded, built) + lightPathText(found));
    return ExitCode::done;
}

// Where a word is explained that is a command, or nearly the name of one and nothing else.
std::string commandHint(const std::string& topic, bool found) {
    if (isCommand(commandTable(), topic)) return fmt::format("`{0}` is a command: `abbe help {0}`", topic);
    const std::string near = found ? std::string() : commandSuggestion(commandTable(), topic);
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
    if (!isCommand(commandTable(), topic))
        console.lines(std::string_view(explanation.text).substr(0, explanation.text.size() - 1));
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
