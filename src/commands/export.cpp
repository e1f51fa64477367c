#include "app/exported_scene.h"
#include "app/json.h"
#include "app/load.h"
#include "command_line/shared_arguments.h"
#include "commands/command_table.h"
#include "exchange/exporter/exporter.h"
#include "scene/build.h"

#include <filesystem>
#include <fmt/format.h>

namespace abbe {

const char* const kExportHelp = R"(Writes a scene for another program.

Examples:
  abbe export room.scene --to mitsuba          room.xml, and what it needs in room-mitsuba-files/
  abbe export room.scene --to pbrt -o new/room.pbrt
  abbe export room.scene --to gltf             room.glb
  abbe export room.scene --to usda             room.usda)";

void addArguments(Arguments& a, ExportOptions& o) {
    a.argument("scene", &o.path, "Scene file, pack, or scene of another program").require();
    a.choice<ExportTarget>("--to", o.to,
                           {{"mitsuba", ExportTarget::mitsuba},
                            {"pbrt", ExportTarget::pbrt},
                            {"gltf", ExportTarget::gltf},
                            {"usda", ExportTarget::usda}},
                           "Format: Mitsuba 3, pbrt-v4, glTF 2.0 or OpenUSD")
        .require();
    a.value("-o,--output", "FILE", &o.output, "File to write; else named after the scene");
    a.flag("--force", &o.force, "Replace a file that is there");
    addDefines(a, o.defines);
    addLayers(a, o.layers);
    addJson(a);
}

namespace {

namespace fs = std::filesystem;

std::string_view nameOfTarget(ExportTarget target) {
    constexpr std::string_view kNames[] = {"mitsuba", "pbrt", "gltf", "usda"};
    return kNames[static_cast<std::size_t>(target)];
}

std::string exportResultText(const std::string& file, std::string_view format, std::size_t remarks, bool json) {
    if (json)
        return Json::object(
                   {{"file", file}, {"format", std::string(format)}, {"warnings", static_cast<std::uint64_t>(remarks)}})
                   .text(true) +
               "\n";
    return fmt::format("{}: {}\n", file,
                       remarks == 0 ? std::string("everything has a counterpart")
                                    : fmt::format("{} remark{}", remarks, remarks == 1 ? "" : "s"));
}

// What is wrong with the scene, before anything is written of it.
ExitCode checkScene(LoadedScene& loaded) {
    BuildOptions build;
    build.geometry = false;
    if (loaded.readable) buildScene(loaded.tree, loaded.types, build, loaded.diagnostics);
    return loaded.exitCode();
}

} // namespace

ExitCode run(const ExportOptions& options, const CommonOptions& common) {
    const exchange::ExportFormat& format = *exchange::findExportFormat(nameOfTarget(options.to));
    const std::string target = options.output.empty()
                                   ? fs::path(options.path).filename().replace_extension(format.extension).string()
                                   : options.output;
    std::error_code error;
    if (!options.force && fs::exists(target, error)) {
        common.console.error(fmt::format("`{}` is there already; `--force` replaces it, `-o` names another", target));
        return ExitCode::usage;
    }
    const auto loaded = loadScene({options.path, options.defines, false, {}, options.layers});
    const ExitCode checked = checkScene(*loaded);
    if (checked != ExitCode::done) {
        common.console.report(loaded->diagnostics, loaded->sources);
        return checked;
    }
    const std::size_t before = loaded->diagnostics.warningCount();
    writeExport(format, *loaded, target);
    const std::size_t remarks = loaded->diagnostics.warningCount() - before;
    common.console.report(loaded->diagnostics, loaded->sources);
    common.console.data(exportResultText(target, format.name, remarks, common.json));
    return ExitCode::done;
}

} // namespace abbe
