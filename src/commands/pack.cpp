#include "app/identity.h"
#include "app/json.h"
#include "app/load.h"
#include "command_line/shared_arguments.h"
#include "commands/command_table.h"
#include "packs/pack_scene.h"
#include "scene/build.h"

#include <filesystem>
#include <fmt/format.h>

namespace abbe {

const char* const kPackHelp = R"(Gathers a scene with all the files that it reads, to render it elsewhere.

Examples:
  abbe pack shot.scene -o shot.abz             one file; abbe render shot.abz renders it on any machine
  abbe pack shot.scene -o shot/                a folder instead
  abbe pack shot.abz -o shot/                  a pack as a folder, to change it
  abbe pack shot.scene -o shot.abz -D fog=0.2  with another value of a parameter)";

void addArguments(Arguments& a, PackOptions& o) {
    a.argument("scene", &o.path, "Scene file").require();
    a.value("-o,--output", "FILE", &o.output, "Pack to write (.abz), or a new folder: shot/").require();
    addDefines(a, o.defines);
    addLayers(a, o.layers);
    addJson(a);
}

namespace {

// What is wrong with the scene is wrong with the pack: it is found here, where it can be mended.
bool isSound(LoadedScene& loaded) {
    BuildOptions build;
    build.geometry = false;
    if (loaded.readable) buildScene(loaded.tree, loaded.types, build, loaded.diagnostics);
    return loaded.exitCode() == ExitCode::done;
}

std::string resultText(const PackOptions& options, const ScenePack& pack, std::uint64_t bytes, bool json) {
    if (!json)
        return fmt::format("{} file{}, {:.1f} MB in {}\n", pack.files.size() + 1, pack.files.empty() ? "" : "s",
                           static_cast<double>(bytes) / 1e6, options.output);
    Json files = Json::list();
    files.push(pack.sceneName);
    for (const ScenePack::File& file : pack.files) files.push(file.name);
    return Json::object({{"pack", options.output}, {"scene", pack.sceneName}, {"bytes", bytes}, {"files", files}})
               .text(true) +
           "\n";
}

} // namespace

ExitCode run(const PackOptions& options, const CommonOptions& common) {
    const auto loaded = loadScene({options.path, options.defines, false, {}, options.layers});
    const bool sound = isSound(*loaded);
    common.console.report(loaded->diagnostics, loaded->sources);
    if (!sound) return loaded->exitCode();
    try {
        const ScenePack pack = packScene(loaded->tree, loaded->sources);
        std::error_code error;
        const bool folder = options.output.ends_with('/') || std::filesystem::is_directory(options.output, error);
        const std::string program = "abbe " + versionNumber();
        const std::uint64_t bytes =
            folder ? writePackFolder(pack, options.output, program) : writePack(pack, options.output, program);
        common.console.data(resultText(options, pack, bytes, common.json));
        return ExitCode::done;
    } catch (const UnpackableFile& file) {
        Diagnostics diagnostics;
        diagnostics.error("E0416", {}, fmt::format("`{}` cannot be given a name in a pack", file.what())).help =
            "rename it, and what names it";
        common.console.report(diagnostics, {});
        return ExitCode::faulty;
    }
}

} // namespace abbe
