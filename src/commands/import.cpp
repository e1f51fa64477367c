#include "app/json.h"
#include "app/load.h"
#include "base/enclosure.h"
#include "command_line/shared_arguments.h"
#include "commands/command_table.h"
#include "exchange/importer/importer.h"
#include "io/file.h"
#include "scene/build.h"

#include <filesystem>
#include <fmt/format.h>

namespace abbe {

const char* const kImportHelp = R"(Makes a scene file of a scene of another program.

Examples:
  abbe import room.xml                         room.scene, and what it needs in room-files/
  abbe import room.xml -o new/room.scene
  abbe import shot.usdc --camera /World/cam --frame 12
  abbe render room.xml                         renders such a scene without keeping what it becomes)";

void addArguments(Arguments& a, ImportOptions& o) {
    a.argument("file", &o.path,
               "Scene of another program: Mitsuba 3 (.xml), pbrt-v4 (.pbrt), glTF (.glb, .gltf), OpenUSD")
        .require();
    a.value("-o,--output", "FILE", &o.output, "Scene file to write (.scene); else named after the other");
    a.flag("--force", &o.force, "Replace a scene file that is there");
    a.value("--camera", "NAME", &o.camera,
            "Camera of an OpenUSD stage; without it that of its settings, else the first");
    addMoment(a, o.frame);
    addSearch(a, o.search);
    addJson(a);
}

namespace {

namespace fs = std::filesystem;

std::string importedName(const ImportOptions& options) {
    if (!options.output.empty()) return options.output;
    return fs::path(options.path).filename().replace_extension(".scene").string();
}

// What a file that no importer takes is; reading it as a scene says that, too.
ExitCode explainRefusal(const std::string& path, const CommonOptions& common) {
    const auto loaded = loadScene({path, {}});
    if (loaded->readable) {
        common.console.error(fmt::format("`{0}` is a scene already: `abbe render {0}`", path));
        return ExitCode::usage;
    }
    common.console.report(loaded->diagnostics, loaded->sources);
    return loaded->exitCode();
}

// Whether the scene that was written is one: else the import is at fault, and says so.
ExitCode checkWritten(const std::string& path, const std::vector<std::string>& search, const Console& console) {
    SceneInput input{path, {}};
    input.layers.search = search;
    const auto loaded = loadScene(input);
    BuildOptions build;
    build.geometry = false;
    if (loaded->readable) buildScene(loaded->tree, loaded->types, build, loaded->diagnostics);
    console.report(loaded->diagnostics, loaded->sources);
    return loaded->exitCode();
}

// What the scene that was written has to be told, if it names files of the foreign one and those are elsewhere.
std::vector<std::string> searchOf(const ImportOptions& options, const std::string& scene) {
    const fs::path foreign = projectOf(fs::path(options.path).parent_path());
    std::vector<std::string> search = options.search;
    if (!mayName(fs::path(scene).parent_path(), foreign)) search.push_back(foreign.string());
    return search;
}

std::string importResultText(const std::string& scene, const std::vector<std::string>& search,
                             const exchange::ImportFormat& format, const Diagnostics& found, bool json) {
    if (json)
        return Json::object({{"scene", scene},
                             {"format", std::string(format.name)},
                             {"warnings", static_cast<std::uint64_t>(found.warningCount())}})
                   .text(true) +
               "\n";
    const std::string lost = found.warningCount() == 0 ? std::string("everything has a counterpart")
                                                       : fmt::format("{} remark{}", found.warningCount(),
                                                                     found.warningCount() == 1 ? "" : "s");
    std::string words;
    for (const std::string& folder : search) words += " --search " + shellQuoted(folder);
    return fmt::format("{0}: {1}; next: abbe render {0}{2}\n", scene, lost, words);
}

} // namespace

ExitCode run(const ImportOptions& options, const CommonOptions& common) {
    const exchange::ImportFormat* const format = exchange::importFormat(options.path);
    if (!format) return explainRefusal(options.path, common);
    const std::string scene = importedName(options);
    std::error_code error;
    if (!options.force && fs::exists(scene, error)) {
        common.console.error(fmt::format("`{}` is there already; `--force` replaces it, `-o` names another", scene));
        return ExitCode::usage;
    }
    const FileReach reach(fs::path(options.path).parent_path(), options.search);
    SourceMap sources;
    Diagnostics diagnostics;
    const auto text = exchange::importScene(*format, options.path, scene, sources, diagnostics,
                                            {options.camera, options.frame, true});
    common.console.report(diagnostics, sources);
    if (!text) return ExitCode::faulty;
    fs::create_directories(fs::path(scene).parent_path(), error);
    flushFileSystem(fs::path(scene).parent_path().string()); // side files before what names them
    writeAtomically(scene, *text);
    const std::vector<std::string> search = searchOf(options, scene);
    if (const ExitCode end = checkWritten(scene, search, common.console); end != ExitCode::done) return end;
    common.console.data(importResultText(scene, search, *format, diagnostics, common.json));
    return ExitCode::done;
}

} // namespace abbe
