#include "app/console.h"
#include "command_line/arguments.h"
#include "command_line/parser.h"
#include "command_line/shared_arguments.h"
#include "commands/command_table.h"
#include "io/exr_reader.h"
#include "reports/image_header.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace abbe {

const char* const kReplayHelp = R"(Takes single samples of a render again and tells what happened, vertex by vertex.

Examples:
  abbe replay room.exr                              all samples that the header lists as dropped
  abbe replay room.scene --pixel 31,7 --sample 1:12      sample 12 of replicate 1, dropped or not
  abbe replay room.exr --pixel 31,7 --sample 1:12 --json

A sample has the bits that it has in the render with the same scene, size, camera, seed and studies.)";

void addArguments(Arguments& a, ReplayOptions& o) {
    BuildOptions& b = o.render.build;
    a.argument("input", &o.render.input.path, "Scene, or an image that was rendered from one").require();
    a.read("--pixel", "X,Y", o.pixel, "a pixel such as 12,34", readAnyPixel, "The pixel");
    a.read("--sample", "R:I", o.sample, "a sample such as 1:12", readSample, "Sample I of replicate R, both from 0");
    a.value("--camera", "NAME", &b.camera, "Camera of the render");
    a.read("--size", "WxH", b.size, "a size such as 640x480", readSize, "Size of the whole image in pixels");
    a.value("--seed", "N", &b.seed, "Seed of the render").between(0, kLargestSeed);
    a.read("--pilot", "N", b.pilot, "0 to 4, or with guiding up to 34", readPilot,
           "Size of its pilots, `abbe.pilot` of the image's header; else by the work");
    addDefines(a, o.render.input.defines, "A parameter of the scene; may be repeated");
    addLayers(a, o.render.input.layers);
    addMoment(a, o.render.input.frame);
    addRate(a, b);
    addTechniques(a, b, "How light was found", "Where random numbers came from", "");
    addThreads(a);
    addJson(a);
}

namespace {

bool isImage(const std::string& path) { return std::filesystem::path(path).extension() == ".exr"; }

std::string attribute(const ExrInfo& info, std::string_view name) {
    for (const ImageAttribute& a : info.attributes)
        if (const auto* text = std::get_if<std::string>(&a.value); text && a.name == name) return *text;
    return {};
}

ExitCode refuse(const CommonOptions& common, const char* code, std::string message, std::string help) {
    Diagnostics diagnostics;
    diagnostics.error(code, {}, std::move(message)).help = std::move(help);
    common.console.report(diagnostics, {});
    return ExitCode::usage;
}

// The render that made an image, or nothing if its header does not tell.
std::optional<RenderOptions> renderOf(const std::string& path, const ExrInfo& info) {
    std::vector<std::string> words = shellWords(attribute(info, "abbe.command"));
    if (words.size() < 2) return std::nullopt;
    std::vector<const char*> arguments;
    for (auto word = words.begin() + 1; word != words.end(); ++word) arguments.push_back(word->c_str());
    const auto result = readCommandLine(commandTable(), arguments);
    const auto* line = std::get_if<CommandLine>(&result);
    const auto* render = line ? optionsOf<RenderOptions>(*line->command) : nullptr;
    if (!render) return std::nullopt;
    RenderOptions options = *render;
    options.frames.clear();
    for (const ImageAttribute& a : info.attributes) {
        const auto* value = std::get_if<int>(&a.value);
        if (value && a.name == "abbe.pilot") options.build.pilot = *value;
        if (value && a.name == "abbe.frame") options.input.frame = *value;
    }
    std::error_code error;
    if (!std::filesystem::exists(options.input.path,
                                 error)) // relative to where it was rendered; perhaps beside the image
        options.input.path = (std::filesystem::path(path).parent_path() / options.input.path).string();
    return options;
}

// A scene that was changed since has other samples.
void compareScene(const CommonOptions& common, const SceneInput& input, const std::string& before) {
    const auto loaded = loadScene(input);
    if (!loaded->readable || before.empty() || sceneHash(*loaded, input) == before) return;
    Diagnostics diagnostics;
    diagnostics.warning("W0673", {}, fmt::format("`{}` was changed since the image was made", input.path)).help =
        "its samples may be others now";
    common.console.report(diagnostics, {});
}

} // namespace

ExitCode run(const ReplayOptions& options, const CommonOptions& common) {
    RenderOptions render = options.render;
    const std::string input = render.input.path;
    std::vector<DroppedSample> listed;
    if (isImage(input)) {
        const ExrInfo info = readExrInfo(input);
        const auto made = renderOf(input, info);
        if (!made)
            return refuse(common, "E0674", fmt::format("the header of `{}` does not tell how it was rendered", input),
                          "name the scene instead: `abbe replay room.scene --pixel X,Y --sample R:I`");
        render = *made;
        compareScene(common, render.input, attribute(info, "abbe.sceneHash"));
        listed = readList(attribute(info, "abbe.droppedSamples"));
    }
    if (options.pixel && options.sample)
        render.replay = {{options.pixel->x, options.pixel->y, options.sample->replicate, options.sample->index}};
    else if (options.pixel || options.sample || !isImage(input))
        return refuse(common, "E0674", "which sample is to be repeated?",
                      "`--pixel X,Y --sample R:I` names it: the I-th of replicate R");
    else
        render.replay.assign(listed.begin(), listed.end());
    if (render.replay.empty()) {
        common.console.line(fmt::format("no sample of `{}` was dropped", input));
        return ExitCode::done;
    }
    render.pixel.reset();
    render.crop.reset();
    render.part.reset();
    render.checkpoint = {};
    return run(render, common);
}

} // namespace abbe
