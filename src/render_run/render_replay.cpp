// Samples that are taken again: what a render says of those that it dropped, and the story of single ones.
#include "app/console.h"
#include "render_run/render_run.h"
#include "rendering/path_record.h"
#include "reports/sample_report.h"

#include <fmt/format.h>

namespace abbe {

// What takes samples of this render again, but for the samples.
std::string RenderRun::replayCommand() const {
    std::string command = "abbe replay " + shellQuoted(options_.input.path);
    const BuildOptions& b = options_.build;
    const auto add = [&](const char* flag, std::string_view value) {
        command += fmt::format(" {} {}", flag, shellQuoted(value));
    };
    for (const auto& [flag, value] : flagsOf(options_.input)) add(flag, value);
    if (options_.input.frame) command += fmt::format(" --frame {}", *options_.input.frame);
    if (b.fps) add("--fps", fmt::format("{}", *b.fps));
    if (!b.camera.empty()) add("--camera", b.camera);
    if (b.size) add("--size", fmt::format("{}x{}", b.size->x, b.size->y));
    if (b.seed) add("--seed", std::to_string(*b.seed));
    if (settings_.pilot >= RenderSettings::kGuidePilot ||
        (settings_.pilot >= 0 && integrator_->lightBlocks(built_.scene, settings_) > 0))
        add("--pilot", std::to_string(settings_.pilot));
    if (b.strategy) add("--strategy", word(*b.strategy));
    if (b.sampler) add("--sampler", word(*b.sampler));
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
            list.push(replayJson(sample, built_.scene));
        else
            common_.console.data((i > 0 ? "\n" : "") + replayText(sample, built_.scene));
    }
    if (common_.json) common_.console.data(list.text(true) + "\n");
    return ExitCode::done;
}

} // namespace abbe
