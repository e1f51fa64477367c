#include "app/load.h"
#include "base/diagnostic.h"
#include "command_line/shared_arguments.h"
#include "commands/command_table.h"
#include "exchange/importer/importer.h"
#include "io/file.h"
#include "scene/build.h"
#include "scene_checks/scene_checks.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

const char* const kCheckHelp = R"(Finds everything that is wrong with scenes, without rendering.

Examples:
  abbe check room.scene
  abbe check --fix room.scene                  repairs what can be repaired safely
  abbe check -q - --as room.scene <room.scene  from an editor: the text comes from standard input
  abbe check --strict --format=short *.scene   for editors and CI)";

namespace {

constexpr const char* kStandardInput = "-";

std::optional<ArgumentFault> contradiction(const CheckOptions& options) {
    const auto standard = std::ranges::count(options.paths, kStandardInput);
    if (standard > 1) return ArgumentFault{"scenes", "standard input can be read once"};
    if (standard > 0 && options.fix) return ArgumentFault{"--fix", "standard input cannot be repaired in place"};
    if (standard == 0 && !options.standsFor.empty())
        return ArgumentFault{"--as", "it is for standard input, `abbe check -`"};
    return std::nullopt;
}

} // namespace

void addArguments(Arguments& a, CheckOptions& o) {
    a.argument("scenes", &o.paths, "Scene files; - is standard input").require();
    a.value("--as", "FILE", &o.standsFor, "What standard input stands for: its name, and the folder of its files");
    a.flag("--fix", &o.fix, "Apply the repairs that are certain, in place");
    a.flag("--quiet,-q", &o.quiet, "Say nothing but warnings and errors");
    a.flag("--strict", &o.strict, "Exit with 4 when there are warnings");
    a.flag("--textures", &o.textures, "Read image textures to their ends, which also makes them ready");
    MessageFormat& format = a.common().format;
    a.choice<MessageFormat>(
        "--format", format,
        {{"human", MessageFormat::human}, {"short", MessageFormat::brief}, {"json", MessageFormat::json}},
        "How faults are told; short: path:line:column: text");
    a.flag(
        "--json", [&format] { format = MessageFormat::json; }, "The same as --format=json");
    addDefines(a, o.defines);
    addLayers(a, o.layers);
    addMoment(a, o.frame);
    a.afterwards([&o] { return contradiction(o); });
}

namespace {

// Only where the camera is inside of something opaque: whether it is dark there takes rays against everything.
void checkDarkness(const LoadedScene& loaded, Diagnostics& diagnostics) {
    Diagnostics again;
    buildScene(loaded.tree, loaded.types, {}, again);
    for (const Diagnostic& d : again.all())
        if (d.code == "W0696") diagnostics.add(d);
}

std::unique_ptr<LoadedScene> checkScene(const SceneInput& input, bool textures = false) {
    auto loaded = loadScene(input);
    BuildOptions options;
    options.geometry = false;
    options.textures = textures;
    if (!loaded->readable) return loaded;
    const BuiltScene built = buildScene(loaded->tree, loaded->types, options, loaded->diagnostics);
    if (checkWholeScene(built, loaded->tree, CheckDepth::surfaces, loaded->diagnostics).cameraInBody)
        checkDarkness(*loaded, loaded->diagnostics);
    return loaded;
}

// Applies what can be applied, again and again until nothing is left: one fix may uncover the next.
std::size_t fixScene(const SceneInput& input) {
    constexpr int kRounds = 64; // each mends a thousand faults of a kind
    std::size_t applied = 0;
    for (int round = 0; round < kRounds; ++round) {
        const auto loaded = checkScene(input);
        if (!loaded->readable) return applied;
        const FileId file{0};
        const FixResult fixed = applyFixes(loaded->sources.text(file), file, loaded->diagnostics);
        if (fixed.applied == 0) return applied;
        applied += fixed.applied;
        writeAtomically(input.path, fixed.text);
    }
    return applied;
}

SceneInput checkedInput(const std::string& path, const CheckOptions& options) {
    if (path != kStandardInput) return {path, options.defines, false, options.frame, options.layers};
    return {options.standsFor.empty() ? "<stdin>" : options.standsFor, options.defines, true, options.frame,
            options.layers};
}

ExitCode checkOne(const SceneInput& input, const CheckOptions& options, const Console& console) {
    if (options.fix && !input.fromStandardInput && exchange::importFormat(input.path)) {
        console.error(
            fmt::format("`{0}` is a scene of another program, which `--fix` does not change; `abbe import {0}` "
                        "makes a scene file of it",
                        input.path));
        return ExitCode::usage;
    }
    if (options.fix && !input.fromStandardInput && isPack(input.path)) {
        console.error(fmt::format("`{0}` is a pack, which `--fix` does not change; `abbe pack {0} -o FOLDER/` makes a "
                                  "folder of it",
                                  input.path));
        return ExitCode::usage;
    }
    const std::size_t fixed = options.fix ? fixScene(input) : 0;
    const auto loaded = checkScene(input, options.textures);
    console.report(loaded->diagnostics, loaded->sources);
    if (console.format() == MessageFormat::human && !options.quiet) {
        if (fixed > 0) console.line(fmt::format("{}: {} repaired", input.path, fixed));
        if (loaded->diagnostics.all().empty()) console.line(fmt::format("{}: no errors, no warnings", input.path));
    }
    if (loaded->exitCode() != ExitCode::done) return loaded->exitCode();
    return options.strict && loaded->diagnostics.warningCount() > 0 ? ExitCode::threshold : ExitCode::done;
}

} // namespace

ExitCode run(const CheckOptions& options, const CommonOptions& common) {
    ExitCode result = ExitCode::done;
    for (const std::string& path : options.paths)
        result = worse(result, checkOne(checkedInput(path, options), options, common.console));
    return result;
}

} // namespace abbe
