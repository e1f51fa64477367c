#include "app/checkpoint_file.h"
#include "app/command_line.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace abbe {

namespace {

// The command that made a part, as it would read the words now.
RenderOptions commandOf(const CheckpointReader& reader) {
    std::vector<const char*> words;
    for (const std::string& word : reader.header().words) words.push_back(word.c_str());
    const auto result = readCommandLine(words);
    if (const auto* command = std::get_if<Command>(&result))
        if (const auto* render = std::get_if<RenderOptions>(&command->options)) return *render;
    throw CheckpointFault("E0661",
                          fmt::format("`{}` was made by a command that this program does not know", reader.path()),
                          "merge it with the program that made it");
}

} // namespace

// A render of the same scene, with the same settings, that finds all its samples done.
ExitCode run(const MergeOptions& options, const CommonOptions& common) {
    try {
        const CheckpointReader first(options.parts.front());
        RenderOptions render = commandOf(first);
        std::error_code error;
        if (!options.scene.empty())
            render.input.path = options.scene;
        else if (!std::filesystem::exists(render.input.path, error)) // it may be relative to where the part was made
            render.input.path = (std::filesystem::path(first.header().folder) / render.input.path).string();
        render.output = options.output;
        render.png = options.png;
        render.view = options.view;
        render.checkpoint = {};
        render.checkpoint.off = true;
        render.crop.reset();
        render.part.reset();
        render.parts = options.parts;
        return run(render, common);
    } catch (const CheckpointFault& fault) {
        Diagnostics diagnostics;
        diagnostics.error(fault.code, {}, fault.what()).help = fault.help;
        common.console.report(diagnostics, {});
        return ExitCode::faulty;
    }
}

} // namespace abbe
