#include "app/image_output.h"
#include "app/interrupt.h"
#include "app/machine.h"
#include "app/options.h"
#include "app/provenance.h"
#include "app/render_report.h"
#include "app/render_warnings.h"
#include "app/stopwatch.h"
#include "base/parallel.h"
#include "integrators/path_tracer.h"
#include "io/io_error.h"

#include <filesystem>
#include <fmt/format.h>

namespace abbe {

namespace {

// One render from the command line to the files. The phases follow each other and are timed.
class RenderRun {
  public:
    RenderRun(const RenderOptions& options, const CommonOptions& common)
        : options_(options), common_(common),
          report_(common.json ? makeJsonReport(common.console)
                              : makeHumanReport(common.console, options.quiet || options.pixel)) {}

    ExitCode run() {
        if (const ExitCode code = load(); code != ExitCode::done) return code;
        if (const ExitCode code = prepare(); code != ExitCode::done) return code;
        if (options_.pixel) return renderPixel();
        const InterruptGuard interrupt;
        PixelFilm film = makeFilm(film_.crop);
        render(film, interrupt);
        write(film);
        return finish(film, interrupt);
    }

  private:
    ExitCode load();
    ExitCode prepare();
    ExitCode checkFilm();
    ExitCode checkOutputs();
    ExitCode refuse(std::string_view code, std::string message, std::string help, ExitCode exit);
    PixelFilm makeFilm(PixelBounds bounds) const {
        return {bounds, PixelFilter(film_.filter, film_.filterRadius), static_cast<int>(built_.render.replicates)};
    }
    ExitCode renderPixel();
    void render(PixelFilm&, const InterruptGuard&);
    void write(const PixelFilm&);
    void writeRescued(const ResolvedImage&, std::vector<ImageAttribute>, const IoError&);
    ExitCode finish(const PixelFilm&, const InterruptGuard&);

    void endPhase(const char* name, double seconds) {
        summary_.phases.emplace_back(name, seconds);
        report_->phase(name, seconds);
    }

    const RenderOptions& options_;
    const CommonOptions& common_;
    std::unique_ptr<RenderReport> report_;
    std::unique_ptr<LoadedScene> loaded_;
    BuiltScene built_;
    FilmSettings film_;
    RenderSettings settings_;
    std::unique_ptr<const Integrator> integrator_;
    RenderSummary summary_;
    Stopwatch watch_;
};

ExitCode RenderRun::load() {
    loaded_ = loadScene(options_.input);
    watch_.lap();
    endPhase("reading", loaded_->parseSeconds);
    endPhase("checking", loaded_->resolveSeconds);
    if (loaded_->readable) {
        built_ = buildScene(loaded_->tree, loaded_->types, options_.build, loaded_->diagnostics);
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

ExitCode RenderRun::checkFilm() {
    for (const FilmFault& fault : findFaults(built_.film))
        return refuse(fault.code, fault.message, fault.help, options_.build.size ? ExitCode::usage : ExitCode::faulty);
    film_ = filmSettings(built_.film);
    const double pixels = static_cast<double>(film_.crop.width()) * film_.crop.height();
    constexpr double kResolved = 5 * sizeof(float); // RGB, variance, and the writer's rows
    const double bytes = pixels * (kResolved + 52.0 * static_cast<double>(built_.render.replicates));
    if (bytes > physicalMemory())
        return refuse("E0650",
                      fmt::format("an image of {}×{} pixels needs {:.3g} GB; this machine has {:.3g} GB of memory",
                                  film_.crop.width(), film_.crop.height(), bytes / 1e9, physicalMemory() / 1e9),
                      "render parts of it with `crop` in the film", ExitCode::memory);
    if (const auto p = options_.pixel; p && (p->x >= film_.width || p->y >= film_.height)) {
        common_.console.error(
            fmt::format("--pixel {},{} is outside the image of {}×{} pixels", p->x, p->y, film_.width, film_.height));
        return ExitCode::usage;
    }
    return ExitCode::done;
}

// Hours of rendering must not end in "permission denied" or "no such view".
ExitCode RenderRun::checkOutputs() {
    summary_.image = imagePath(options_, film_);
    summary_.png = pngPath(options_, summary_.image);
    if (std::filesystem::path(summary_.image).extension() != ".exr")
        return refuse("E0431", fmt::format("the image `{}` must be an EXR", summary_.image),
                      "name it `….exr`; `--png=FILE` adds a PNG", ExitCode::usage);
    for (const std::string& path : {summary_.image, summary_.png}) {
        if (path.empty()) continue;
        if (std::string fault = writeFault(path); !fault.empty())
            return refuse("E0430", std::move(fault), "`-o FILE` writes the image elsewhere", ExitCode::system);
    }
    checkView(options_.view, options_.png.has_value());
    return ExitCode::done;
}

ExitCode RenderRun::prepare() {
    if (const ExitCode code = checkFilm(); code != ExitCode::done) return code;
    if (!options_.pixel)
        if (const ExitCode code = checkOutputs(); code != ExitCode::done) return code;
    settings_ = renderSettings(built_.render);
    integrator_ = makePathTracer(options_.largestKernel ? kAllEffects : built_.scene.effects);
    return ExitCode::done;
}

// One pixel takes the samples that it takes in the whole image, so a fault can be looked at again.
ExitCode RenderRun::renderPixel() {
    const Vec2i at = *options_.pixel;
    PixelFilm film = makeFilm({at.x, at.y, at.x + 1, at.y + 1});
    const RenderStatistics statistics = integrator_->render(built_.scene, film, settings_, {});
    const Xyz xyz = film.mean(at.x, at.y) * built_.exposure;
    const ResolvedImage image = resolveImage(film, film_, built_.exposure);
    common_.console.data(fmt::format("pixel {} {}\nXYZ {:.9g} {:.9g} {:.9g}\n{} {:.9g} {:.9g} {:.9g}\nsamples {}\n",
                                     at.x, at.y, xyz.x, xyz.y, xyz.z, spaceName(film_.space), image.r[0], image.g[0],
                                     image.b[0], statistics.samplesPerPixel));
    Diagnostics warnings;
    warnOfDroppedSamples(statistics, warnings);
    for (const auto& texture : built_.scene.textures) texture->reportLookups(warnings);
    report_->diagnostics(warnings, loaded_->sources);
    return ExitCode::done;
}

void RenderRun::render(PixelFilm& film, const InterruptGuard& interrupt) {
    report_->start({options_.input.path, summary_.image, film_.crop.width(), film_.crop.height(), threadCount(),
                    settings_.samples, settings_.noiseTarget, settings_.timeLimit});
    const RenderControl control{&interrupt.stop(), [this](const Progress& p) { report_->progress(p); }};
    watch_.lap();
    summary_.statistics = integrator_->render(built_.scene, film, settings_, control);
    endPhase("rendering", watch_.lap());
    summary_.noise = film.relativeNoise();
    summary_.partial = summary_.statistics.stopped;
}

void RenderRun::write(const PixelFilm& film) {
    double seconds = 0;
    for (const auto& phase : summary_.phases) seconds += phase.second;
    auto attributes =
        provenance({loaded_.get(), &options_.input, &built_, &settings_, &summary_.statistics, common_.commandLine,
                    std::string(spaceName(film_.space)), summary_.noise, seconds, film.replicates()});
    for (ImageAttribute& a : viewIdentity(options_.view)) attributes.push_back(std::move(a));
    const ResolvedImage image = resolveImage(film, film_, built_.exposure);
    Diagnostics warnings;
    try {
        writeImage(summary_.image, image, film_, attributes, warnings);
    } catch (const IoError& e) {
        writeRescued(image, std::move(attributes), e);
    }
    report_->image(summary_.image, summary_.partial);
    if (!summary_.png.empty()) {
        DisplayPicture picture{image.bounds.width(), image.bounds.height(), {}, film_.space};
        picture.rgb.reserve(3 * image.r.size());
        for (std::size_t i = 0; i < image.r.size(); ++i)
            picture.rgb.insert(picture.rgb.end(), {image.r[i], image.g[i], image.b[i]});
        writeDisplayPng(summary_.png, std::move(picture), options_.view, 8);
        report_->image(summary_.png, summary_.partial);
    }
    endPhase("writing", watch_.lap());
    warnOfDroppedSamples(summary_.statistics, warnings);
    warnOfDensities(summary_.statistics.excess, warnings);
    for (const auto& texture : built_.scene.textures) texture->reportLookups(warnings);
    warnOfBlackImage(image, warnings);
    report_->diagnostics(warnings, loaded_->sources);
    summary_.warnings += warnings.warningCount();
}

// The disk filled up or went away while rendering: what was computed is saved where temporary files go.
void RenderRun::writeRescued(const ResolvedImage& image, std::vector<ImageAttribute> attributes, const IoError& why) {
    const auto rescued = std::filesystem::temp_directory_path() / std::filesystem::path(summary_.image).filename();
    Diagnostics ignored;
    writeImage(rescued.string(), image, film_, std::move(attributes), ignored);
    throw IoError(fmt::format("{}; the image was saved as `{}`", why.what(), rescued.string()));
}

ExitCode RenderRun::finish(const PixelFilm&, const InterruptGuard& interrupt) {
    summary_.exit = ExitCode::done;
    if (options_.strict && summary_.warnings > 0) summary_.exit = ExitCode::threshold;
    if (interrupt.signal() != 0) summary_.exit = static_cast<ExitCode>(128 + interrupt.signal());
    for (const auto& phase : summary_.phases) summary_.totalSeconds += phase.second;
    summary_.width = film_.crop.width();
    summary_.height = film_.crop.height();
    summary_.space = spaceName(film_.space);
    summary_.memoryBytes = peakMemory();
    report_->done(summary_);
    return summary_.exit;
}

} // namespace

ExitCode run(const RenderOptions& options, const CommonOptions& common) { return RenderRun(options, common).run(); }

} // namespace abbe
