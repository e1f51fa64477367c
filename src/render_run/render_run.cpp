#include "render_run/render_run.h"

#include "app/identity.h"
#include "base/enclosure.h"
#include "base/memory_limit.h"
#include "base/parallel.h"
#include "checkpoints/render_identity.h"
#include "checkpoints/render_parts.h"
#include "pictures/display_view.h"
#include "render_run/frame_run.h"
#include "rendering/path_tracer.h"
#include "reports/image_header.h"
#include "reports/render_text.h"
#include "reports/render_warnings.h"
#include "scene_checks/scene_checks.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace abbe {

ExitCode RenderRun::load() {
    SceneInput input = options_.input;
    input.camera = options_.build.camera;
    loaded_ = carry_ ? carry_->scenes.load(input) : loadScene(input);
    watch_.lap();
    endPhase("reading", loaded_->parseSeconds);
    endPhase("checking", loaded_->resolveSeconds);
    if (loaded_->readable) {
        const WorkScope work(Work::building);
        built_ = buildScene(loaded_->tree, loaded_->types, options_.build, loaded_->diagnostics,
                            carry_ ? &carry_->reuse : nullptr);
        checkWholeScene(built_, loaded_->tree, CheckDepth::amounts, loaded_->diagnostics);
        const double seconds = watch_.lap();
        endPhase("building", seconds - built_.commitSeconds);
        endPhase("committing", built_.commitSeconds);
    }
    report_->diagnostics(loaded_->diagnostics, loaded_->sources);
    summary_.warnings = loaded_->diagnostics.warningCount();
    return loaded_->exitCode();
}

ExitCode RenderRun::refuse(std::string_view code, std::string message, std::string help, ExitCode exit) {
    Diagnostics diagnostics;
    diagnostics.error(std::string(code), {}, std::move(message)).help = std::move(help);
    report_->diagnostics(diagnostics, loaded_->sources);
    return exit;
}

// Located, since `deep MOST` is the way out.
void RenderRun::warnOfDeepMemory() {
    if (!built_.layers.deep || options_.pixel) return;
    const std::uint64_t most =
        DeepSums::mostBytes(layersAtOnce(), *built_.layers.deep, static_cast<std::uint64_t>(built_.render.samples));
    if (static_cast<double>(most) <= physicalMemory()) return;
    Span span;
    for (const schema::TableRow& row : built_.film.layers.rows)
        if (!row.cells.empty() && row.cells[0].text == "deep") span = row.span;
    Diagnostics diagnostics;
    diagnostics
        .warning("W0657", span,
                 fmt::format("the deep samples may take up to {:.3g} GB; this machine has {:.3g} GB of memory",
                             static_cast<double>(most) / 1e9, physicalMemory() / 1e9),
                 "where media fill the picture")
        .help = "keep fewer of them, `deep 8`, or render parts with `crop`";
    report_->diagnostics(diagnostics, loaded_->sources);
    ++summary_.warnings;
}

ExitCode RenderRun::checkFilm() {
    for (const FilmFault& fault : findFaults(built_.film))
        return refuse(fault.code, fault.message, fault.help, options_.build.size ? ExitCode::usage : ExitCode::faulty);
    film_ = filmSettings(built_.film);
    if (const auto c = options_.crop) {
        const PixelBounds& all = film_.overscan;
        if (c->x0 < all.x0 || c->y0 < all.y0 || c->x1 > all.x1 || c->y1 > all.y1)
            return refuse("E0609",
                          fmt::format("--crop {},{},{},{} reaches outside the image, which is {},{},{},{}", c->x0,
                                      c->y0, c->x1, c->y1, all.x0, all.y0, all.x1, all.y1),
                          "left and top are inside, right and bottom exclusive", ExitCode::usage);
        film_.crop = *c;
    }
    if (const ExitCode code = checkMemory(); code != ExitCode::done) return code;
    warnOfDeepMemory();
    if (const auto p = options_.pixel; p && (p->x >= film_.width || p->y >= film_.height)) {
        common_.console.error(
            fmt::format("--pixel {},{} is outside the image of {}×{} pixels", p->x, p->y, film_.width, film_.height));
        return ExitCode::usage;
    }
    return ExitCode::done;
}

// Hours of rendering must not end in "permission denied" or "no such view".
ExitCode RenderRun::checkOutputs() {
    const bool makesPart = options_.part || options_.mergesToPart();
    if (options_.inMemory && !makesPart) {
        certificateAlso_ = false;
        checkView(options_.view, false);
        return ExitCode::done;
    }
    const std::string asked = imagePath(options_.output, film_, options_.input.path);
    if (std::string fault = framePatternFault(asked); options_.frame && !fault.empty())
        return refuse("E0433", std::move(fault), "`####` stands for the frame's number with four digits",
                      ExitCode::usage);
    summary_.image = options_.frame ? frameImagePath(asked, options_.frame->number, options_.part) : asked;
    if (options_.part && !options_.frame) summary_.image = partPath(asked, *options_.part);
    if (options_.mergesToPart() && isForeignCheckpoint(summary_.image))
        return refuse("E0661", fmt::format("`{}` is there already, and was not made by this program", summary_.image),
                      "`-o FILE` writes the part elsewhere", ExitCode::faulty);
    if (!makesPart && std::filesystem::path(summary_.image).extension() != ".exr")
        return refuse("E0431", fmt::format("the image `{}` must be an EXR", summary_.image),
                      "name it `….exr`; a PNG is written beside it", ExitCode::usage);
    if (options_.output.empty() && !film_.output.empty() && !mayName(".", asked) &&
        !mayName(options_.input.path, asked))
        return refuse("E0417", fmt::format("the image `{}` is outside of the scene's project", summary_.image),
                      "a scene writes below its own folder or the current one; `-o FILE` writes the image anywhere",
                      ExitCode::faulty);
    if (built_.layers.deep && !makesPart) summary_.deep = deepPath(summary_.image);
    for (const std::string& path : {summary_.image, summary_.deep}) {
        if (path.empty()) continue;
        if (std::string fault = writeFault(path); !fault.empty())
            return refuse("E0430", std::move(fault), "`-o FILE` writes the image elsewhere", ExitCode::system);
    }
    if (!summary_.deep.empty() && isForeignDeep(summary_.deep))
        return refuse("E0430", fmt::format("`{}` is there already, and was not made by this program", summary_.deep),
                      "move it, write the image elsewhere with `-o FILE`, or leave `deep` out of the layers",
                      ExitCode::faulty);
    if (const std::string path = summary_.image + ".json"; !makesPart && isForeignCertificate(path)) {
        certificateAlso_ = false;
        warn("W0667",
             fmt::format("no certificate will be written: `{}` is there already, and was not made by this program",
                         path),
             "the header of the image has it");
    }
    return makesPart ? ExitCode::done : checkPng();
}

// Of a round of parts.
ExitCode RenderRun::checkSkip() {
    const std::uint32_t replicates = built_.render.replicates;
    if (options_.skip == 0) return ExitCode::done;
    if (!options_.part)
        return refuse("E0760", "--skip leaves samples out that an earlier round of parts has, so it needs --part",
                      "`--part 1/1` is all that is left", ExitCode::usage);
    if (options_.skip % replicates != 0)
        return refuse("E0760",
                      fmt::format("--skip {}: each of the {} replicates has the same number of samples", options_.skip,
                                  replicates),
                      fmt::format("`--skip {}`", (options_.skip / replicates + 1) * replicates), ExitCode::usage);
    if (options_.skip >= settings_.samples)
        return refuse("E0760", fmt::format("--skip {} leaves nothing of {} samples", options_.skip, settings_.samples),
                      "`--samples` is the number of the whole render, earlier rounds included", ExitCode::usage);
    settings_.skip = options_.skip;
    return ExitCode::done;
}

// Once in an animation.
void RenderRun::warnOfFrames() {
    if (!options_.frame || options_.frame->count < 2 || options_.frame->position > 1) return;
    if (!loaded_->changesWithFrames())
        warn("W0698",
             "all frames are alike but for their noise: nothing in this scene has keys, and it uses no parameter "
             "`frame`",
             "give keys to what shall move, `transform { at 0 s { … }; at 1 s { … } }`, or write `param frame 0` and "
             "use `$frame`");
    if (built_.cameraExposure.automatic && !options_.part)
        warn("W0699", "`exposure auto` is found for each frame by itself: the picture may flicker",
             "write the stops that one frame prints into the camera, `exposure 3 stops`");
}

ExitCode RenderRun::prepare() {
    settings_ = renderSettings(built_.render);
    settings_.pilot = options_.build.pilot.value_or(RenderSettings::kPilotByWork);
    if (alone()) settings_.timeLimit = 0;
    integrator_ = makePathTracer(options_.largestKernel ? kLoopEffects : built_.scene.effects);
    if (const ExitCode code = checkFilm(); code != ExitCode::done) return code;
    if (!alone())
        if (const ExitCode code = checkOutputs(); code != ExitCode::done) return code;
    if (const ExitCode code = checkSkip(); code != ExitCode::done) return code;
    if (options_.part) {
        settings_.part = static_cast<std::uint32_t>(options_.part->x);
        settings_.parts = static_cast<std::uint32_t>(options_.part->y);
    }
    warnOfFrames();
    meter();
    return ExitCode::done;
}

// One pixel takes the samples that it takes in the whole image, so a fault can be looked at again.
ExitCode RenderRun::renderPixel() {
    const Vec2i at = *options_.pixel;
    PixelFilm film = makeFilm({at.x, at.y, at.x + 1, at.y + 1});
    const RenderStatistics statistics = integrator_->render(built_.scene, film, settings_, {});
    const std::uint64_t samples = film.samples(at.x, at.y);
    const Xyz xyz = film.mean(at.x, at.y) * built_.exposure;
    const ResolvedImage image = resolveImage(film, film_, built_.exposure);
    common_.console.data(fmt::format("pixel {} {}\nXYZ {:.9g} {:.9g} {:.9g}\n{} {:.9g} {:.9g} {:.9g}\nsamples {}\n",
                                     at.x, at.y, xyz.x, xyz.y, xyz.z, spaceName(film_.space), image.r[0], image.g[0],
                                     image.b[0], samples));
    Diagnostics warnings;
    summary_.statistics = statistics;
    findDropped(film);
    warnOfDroppedSamples(statistics, summary_.faults, replayCommand(), warnings);
    warnOfCappedPaths(statistics, built_, warnings);
    for (const auto& texture : built_.scene.textures) texture->reportLookups(warnings);
    report_->diagnostics(warnings, loaded_->sources);
    return ExitCode::done;
}

void RenderRun::warn(const char* code, std::string message, std::string help) {
    Diagnostics diagnostics;
    diagnostics.warning(code, {}, std::move(message)).help = std::move(help);
    report_->diagnostics(diagnostics, loaded_->sources);
    ++summary_.warnings;
}

// Once a second, and textures at the end.
void RenderRun::watch(InterruptGuard& interrupt, const Progress& p) {
    if (lostTexture_ || outOfMemory_ || (p.fraction < 1 && p.elapsed < watchedUntil_ + 1)) return;
    watchedUntil_ = p.elapsed;
    lostTexture_ = !texturesReadable();
    const auto taken = static_cast<double>(residentMemory());
    if (p.fraction < 1 && taken > memoryBudget()) {
        outOfMemory_ = true;
        beyondBudget_ = taken;
    }
    if (lostTexture_ || outOfMemory_) interrupt.requestStop();
}

void RenderRun::renderFrom(PixelFilm& film, RenderState& state, InterruptGuard& interrupt) {
    const auto progress = [this, &interrupt](const Progress& p) {
        tellFault();
        watch(interrupt, p);
        tellOfTev();
        report_->progress(p);
    };
    const auto onSnapshot = [&](const RenderStatistics& statistics) { snapshot(film, statistics); };
    RenderControl control{&interrupt.stop(), progress, &state, &interrupt.snapshot(), onSnapshot};
    control.framePreview = [this, &interrupt](const FramePreview& look) {
        look_ = look;
        Diagnostics found;
        warnOfEndlessPaths(look, built_, settings_.timeLimit > 0 ? 0 : static_cast<double>(settings_.samples), found);
        report_->diagnostics(found, loaded_->sources);
        summary_.warnings += found.warningCount();
        if (preview_ && !interrupt.stop() && preview_->show(look)) report_->preview(preview_->path());
        if (tev_) tev_->show(look);
    };
    control.passEnded = [&] {
        const bool last = state.reached() >= settings_.range(film.replicates()).last;
        if (preview_ && !last && preview_->show(film)) report_->preview(preview_->path());
        if (tev_ && !last) tev_->show(film);
    };
    try {
        const WorkScope work(Work::none);
        summary_.statistics = integrator_->render(built_.scene, film, settings_, control);
        settings_.pilot = state.pilot(); // for samples that are taken again
    } catch (const std::bad_alloc& e) {
        if (const auto* limit = dynamic_cast<const MemoryLimitExceeded*>(&e)) shortage_ = limit->what();
        // A tile in hand may be in the film in part: good enough for the image, which says that it is partial, but not
        // to go on from. The checkpoint stays as it was written last.
        outOfMemory_ = true;
        if (checkpoint_ && checkpoint_->isThere()) olderCheckpoint_ = checkpoint_->path();
        checkpoint_.reset();
        summary_.statistics.stopped = true;
        summary_.statistics.samplesPerPixel = (state.reached() - state.first()) * built_.render.replicates;
        summary_.statistics.examples = state.examples();
    }
}

void RenderRun::render(PixelFilm& film, RenderState& state, InterruptGuard& interrupt) {
    report_->start({options_.input.path, summary_.image, film_.crop.width(), film_.crop.height(), threadCount(),
                    settings_.samples, settings_.noiseTarget, settings_.timeLimit, built_.shutter.open});
    watch_.lap();
    renderFrom(film, state, interrupt);
    summary_.partial = summary_.statistics.stopped || lostTexture_ || outOfMemory_;
    summary_.statistics.stopped = summary_.partial;
    allBegun_ = state.allBegun();
    hasSamples_ = !state.empty() || state.reached() >= settings_.range(film.replicates()).last;
    hasPicture_ = hasSamples_ || (!summary_.partial && !options_.part && look_ && !look_->cells.empty());
    closeCheckpoint();
    endPhase("rendering", watch_.lap());
    summary_.noise = film.relativeNoise();
    if (!interrupt.stop() && !outOfMemory_) findDropped(film);
}

// Parts that were rendered elsewhere, as if it had been here.
ExitCode RenderRun::merge() {
    try {
        const PartsWanted wanted = options_.mergesToPart() ? PartsWanted::range
                                   : options_.soFar        ? PartsWanted::soFar
                                                           : PartsWanted::whole;
        RenderParts parts(options_.parts, wanted);
        parts.check(identity());
        film_.crop = parts.bounds();
        settings_.pilot = parts.pilot();
        const PixelBounds& all = film_.crop;
        PixelFilm film = makeFilm(all, PixelBounds{all.x0, all.y0, all.x1, all.y0});
        watch_.lap();
        const WorkScope work(Work::merging);
        settings_.samples = parts.whole() * static_cast<std::uint32_t>(film.replicates());
        summary_.statistics = parts.addTo(film);
        summary_.partial = summary_.statistics.stopped;
        earlier_ = parts.work();
        summary_.noise = film.relativeNoise();
        endPhase("merging", watch_.lap());
        if (options_.mergesToPart()) {
            parts.write(summary_.image, film);
            report_->image(summary_.image, false);
            return finish(0);
        }
        setWork(Work::preparing);
        findDropped(film);
        bringLayers_ = [&](PixelBounds rows) { parts.bringLayers(film, rows); };
        write(film);
    } catch (const CheckpointFault& fault) {
        return refuse(fault.code.c_str(), fault.what(), fault.help, ExitCode::faulty);
    }
    return finish(0);
}

// A render that came to nothing writes nothing: what an earlier one left is worth more than a black picture.
ExitCode RenderRun::leaveFiles() {
    std::error_code ignored;
    const std::string path = std::exchange(summary_.image, {});
    const std::string file =
        path.empty() ? "there is no picture"
                     : fmt::format("`{}` {}", path,
                                   std::filesystem::exists(path, ignored) ? "stays as it was" : "was not written");
    summary_.deep.clear();
    if (!summary_.partial)
        return refuse("E0669", fmt::format("the time ended before anything was seen; {}", file),
                      "give it more `--time`, or a smaller `--size`", ExitCode::threshold);
    if (!outOfMemory_ && !lostTexture_)
        warn("W0648", fmt::format("the render was ended before its first sample; {}", file),
             "let it render a little longer; `--time` ends a render with a picture");
    return ExitCode::done;
}

ExitCode RenderRun::finish(int signal, ExitCode otherwise) {
    summary_.exit = otherwise;
    if (options_.strict && summary_.warnings > 0) summary_.exit = ExitCode::threshold;
    if (outOfMemory_) summary_.exit = refuseForMemory();
    if (outOfMemory_ && !imageWritten_) summary_.image.clear();
    if (lostTexture_)
        summary_.exit = refuse("E0666",
                               "a texture could not be read any more (W0458), so the render was ended" +
                                   (hasPicture_ ? fmt::format("; the image so far is in `{}`, black where the texture "
                                                              "should be",
                                                              summary_.image)
                                                : std::string()),
                               checkpoint_ && checkpoint_->isThere()
                                   ? "the checkpoint is of before that: bring the file back and go on with `--resume`"
                                   : "bring the file back and render again",
                               ExitCode::faulty);
    if (signal != 0) summary_.exit = static_cast<ExitCode>(128 + signal);
    if (checkpoint_ && summary_.partial && hasSamples_ && !options_.checkpoint.off)
        tellHowToResume();
    else if (checkpoint_ && !summary_.partial && !options_.part && !options_.checkpoint.keep)
        checkpoint_->remove();
    preview_.reset();
    for (const auto& phase : summary_.phases) summary_.totalSeconds += phase.second;
    summary_.width = film_.crop.width();
    summary_.height = film_.crop.height();
    summary_.space = spaceName(film_.space);
    summary_.memoryBytes = peakMemory();
    summary_.cost = cost();
    if (options_.cost && !common_.json) common_.console.data(costTable(*summary_.cost));
    report_->done(summary_);
    return summary_.exit;
}

} // namespace abbe
