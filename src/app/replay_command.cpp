// Samples of a render once more, by themselves and told vertex by vertex.
#include "app/argument_values.h"
#include "app/command_line.h"
#include "app/provenance.h"
#include "app/render_run.h"
#include "app/replay_story.h"
#include "io/exr_reader.h"
#include "rendering/path_record.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace abbe {

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
    const auto result = readCommandLine(arguments);
    const auto* command = std::get_if<Command>(&result);
    const auto* render = command ? std::get_if<RenderOptions>(&command->options) : nullptr;
    if (!render) return std::nullopt;
    RenderOptions options = *render;
    for (const ImageAttribute& a : info.attributes)
        if (const auto* size = std::get_if<int>(&a.value); size && a.name == "abbe.pilot") options.build.pilot = *size;
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

// What takes samples of this render again, but for the samples.
std::string RenderRun::replayCommand() const {
    std::string command = "abbe replay " + shellQuoted(options_.input.path);
    const BuildOptions& b = options_.build;
    const auto add = [&](const char* flag, const std::string& value) {
        command += fmt::format(" {} {}", flag, shellQuoted(value));
    };
    for (const std::string& define : options_.input.defines) add("-D", define);
    if (!b.camera.empty()) add("--camera", b.camera);
    if (b.size) add("--size", fmt::format("{}x{}", b.size->x, b.size->y));
    if (b.seed) add("--seed", std::to_string(*b.seed));
    if (settings_.pilot >= 0 && integrator_->lightBlocks(built_.scene, settings_) > 0)
        add("--pilot", std::to_string(settings_.pilot));
    if (!b.strategy.empty()) add("--strategy", b.strategy);
    if (!b.sampler.empty()) add("--sampler", b.sampler);
    return command;
}

void RenderRun::findDropped(const Film& film) {
    summary_.faults =
        findFaults(summary_.statistics.examples, *integrator_, built_.scene, loaded_->tree, film, settings_);
}

ExitCode RenderRun::replay() {
    const auto replicates = static_cast<int>(built_.render.replicates);
    for (const SampleId& s : options_.replay) {
        if (s.x >= film_.width || s.y >= film_.height)
            return refuse(
                "E0673",
                fmt::format("pixel {} is outside the image of {}×{} pixels", pixelText(s), film_.width, film_.height),
                "the first pixel is 0,0", ExitCode::usage);
        if (s.replicate >= replicates)
            return refuse("E0673",
                          fmt::format("there is no replicate {}: the scene has {}, from 0", s.replicate, replicates),
                          "`--sample R:I` is the I-th sample of replicate R", ExitCode::usage);
    }
    const SampleId& first = options_.replay.front();
    const PixelFilm film = makeFilm({first.x, first.y, first.x + 1, first.y + 1});
    WatchedFilm watched(film, options_.replay);
    integrator_->repeat(built_.scene, watched, settings_, options_.replay);
    Json list = Json::list();
    for (std::size_t i = 0; i < options_.replay.size(); ++i) {
        const PathRecord& record = watched.records()[i];
        std::optional<FoundFault> fault;
        if (!record.kept()) fault = describeFault({options_.replay[i], {}}, record, built_.scene, loaded_->tree);
        const ReplayedSample sample{options_.replay[i], record, fault ? &*fault : nullptr, built_.exposure};
        if (common_.json)
            list.push(storyJson(sample, built_.scene));
        else
            common_.console.data((i > 0 ? "\n" : "") + storyText(sample, built_.scene));
    }
    if (common_.json) common_.console.data(list.text(true) + "\n");
    return ExitCode::done;
}

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
