#include "checkpoints/checkpoint_reader.h"
#include "checkpoints/render_identity.h"
#include "command_line/parser.h"
#include "command_line/shared_arguments.h"
#include "commands/command_table.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace abbe {

const char* const kMergeHelp = R"(Puts parts of a render together, to the bits of the whole.

Examples:
  abbe merge room.part*.abbe -o room.exr
  abbe merge left.part1.abbe right.part1.abbe -o room.exr      crops with the same samples
  abbe merge room.part[1-9].abbe -o room.first9.abbe           one part instead of nine, to be merged later
  abbe merge room.part*.abbe --so-far -o look.exr              what there is, of parts that are still rendered)";

void addArguments(Arguments& a, MergeOptions& o) {
    a.argument("parts", &o.parts, "Parts of one render (.abbe)").require();
    a.value("-o,--output", "FILE", &o.output, "Image to write (EXR), or one part for all (.abbe)").require();
    a.flag("--so-far", &o.soFar, "Leave out what is missing: of parts that are not finished, or not there");
    a.value("--scene", "FILE", &o.scene, "Where the scene is now");
    addSearch(a, o.search);
    addPng(a, o.png, o.view);
    addView(a, o.view);
    addJson(a);
}

namespace {

// The command that made a part, as it would read the words now.
RenderOptions commandOf(const CheckpointReader& reader) {
    const auto result = readCommandLine(commandTable(), reader.header().words);
    if (const auto* line = std::get_if<CommandLine>(&result))
        if (const auto* render = optionsOf<RenderOptions>(*line->command)) return *render;
    throw CheckpointFault("E0661",
                          fmt::format("`{}` was made by a command that this program does not know", reader.path()),
                          "merge it with the program that made it");
}

} // namespace

RenderOptions renderOf(const MergeOptions& options) {
    const CheckpointReader first(options.parts.front());
    RenderOptions render = commandOf(first);
    // What the command named may be relative to where the part was made.
    const auto now = [&](const std::string& path) {
        std::error_code error;
        if (std::filesystem::exists(path, error)) return path;
        return (std::filesystem::path(first.header().folder) / path).string();
    };
    render.input.path = options.scene.empty() ? now(render.input.path) : options.scene;
    std::vector<std::string>& search = render.input.layers.search;
    std::ranges::transform(search, search.begin(), now);
    search.insert(search.end(), options.search.begin(), options.search.end());
    render.output = options.output;
    render.png = options.png;
    render.view = options.view;
    render.checkpoint = {};
    render.checkpoint.off = true;
    render.crop.reset();
    render.part.reset();
    render.skip = 0;
    render.frames.clear();
    render.input.frame = frameOf(first.header().identity);
    render.parts = options.parts;
    render.soFar = options.soFar;
    return render;
}

ExitCode run(const MergeOptions& options, const CommonOptions& common) {
    try {
        return run(renderOf(options), common);
    } catch (const CheckpointFault& fault) {
        common.console.report(fault);
        return ExitCode::faulty;
    }
}

} // namespace abbe
