#include "app/image_output.h"
#include "app/interrupt.h"
#include "app/machine.h"
#include "app/options.h"
#include "app/provenance.h"
#include "app/render_checkpoint.h"
#include "app/render_identity.h"
#include "app/render_parts.h"
#include "app/render_report.h"
#include "app/render_warnings.h"
#include "app/stopwatch.h"
#include "base/parallel.h"
#include "integrators/path_tracer.h"
#include "io/io_error.h"
#include "render/render_state.h"

#include <algorithm>
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
        if (!options_.parts.empty()) return merge();
        InterruptGuard interrupt;
        PixelFilm film = makeFilm(film_.crop);
        RenderState state(film.bounds(), settings_.range(film.replicates()).first);
        if (const ExitCode code = openCheckpoint(film, state); code != ExitCode::done) return code;
        render(film, state, interrupt);
        if (!options_.part) write(film);
        return finish(interrupt.signal());
    }

  private:
    ExitCode load();
    ExitCode prepare();
    ExitCode checkFilm();
    ExitCode checkOutputs();
    ExitCode refuse(std::string_view code, std::string message, std::string help, ExitCode exit);
    PixelFilm makeFilm(PixelBounds bounds) const {
        PixelFilm film(bounds, PixelFilter(film_.filter, film_.filterRadius),
                       static_cast<int>(built_.render.replicates));
        if (!options_.pixel) film.keepLayers(built_.layers, built_.scene.names, rgbSpace(film_.space));
        return film;
    }
    ExitCode renderPixel();
    ExitCode merge();
    ExitCode openCheckpoint(PixelFilm&, RenderState&);
    CheckpointHeader checkpointHeader() const;
    std::vector<Fact> identity() const;
    void render(PixelFilm&, RenderState&, InterruptGuard&);
    void renderFrom(PixelFilm&, RenderState&, InterruptGuard&);
    void snapshot(const PixelFilm&, const RenderStatistics&);
    void closeCheckpoint();
    void tellFault();
    bool texturesReadable() const;
    void watchTextures(InterruptGuard&, const Progress&);
    void tellHowToResume() const;
    void warn(const char* code, std::string message, std::string help);
    void write(const PixelFilm&);
    std::vector<ImageAttribute> attributes(const PixelFilm&) const;
    void writePng(const ResolvedImage&);
    void writeRescued(const FilmPicture&, std::vector<ImageAttribute>, const IoError&);
    FilmPicture pictureOf(const PixelFilm& film) const {
        return resolvePicture(film, film_, built_.exposure, built_.scene.origin);
    }
    ExitCode finish(int signal);

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
    std::optional<RenderCheckpoint> checkpoint_;
    bool outOfMemory_ = false; // while rendering
    bool lostTexture_ = false;
    double watchedUntil_ = 0; // s, the textures
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
    if (const auto c = options_.crop) {
        if (c->x1 > film_.width || c->y1 > film_.height)
            return refuse("E0609",
                          fmt::format("--crop ends at {},{}, outside the image of {}×{} pixels", c->x1, c->y1,
                                      film_.width, film_.height),
                          "left and top are inside, right and bottom exclusive", ExitCode::usage);
        film_.crop = *c;
    }
    const double pixels = static_cast<double>(film_.crop.width()) * film_.crop.height();
    constexpr double kResolved = 5 * sizeof(float); // RGB, variance, and the writer's rows
    const double bytes = pixels * (kResolved + 52.0 * static_cast<double>(built_.render.replicates)) +
                         static_cast<double>(FilmLayers::memoryBytes(film_.crop, built_.layers));
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
    if (options_.part) {
        summary_.image = partPath(summary_.image, *options_.part);
        summary_.png.clear();
    }
    if (!options_.part && std::filesystem::path(summary_.image).extension() != ".exr")
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
    if (options_.part) {
        settings_.part = static_cast<std::uint32_t>(options_.part->x);
        settings_.parts = static_cast<std::uint32_t>(options_.part->y);
    }
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

std::vector<Fact> RenderRun::identity() const {
    return renderIdentity(
        {loaded_.get(), &film_, &settings_, static_cast<int>(built_.render.replicates), options_.build.camera});
}

CheckpointHeader RenderRun::checkpointHeader() const {
    CheckpointHeader header;
    header.words = common_.words;
    header.folder = std::filesystem::current_path().string();
    header.bounds = film_.crop;
    header.replicates = static_cast<int>(built_.render.replicates);
    const SampleRange range = settings_.range(header.replicates);
    header.first = range.first;
    header.last = range.last;
    header.whole = settings_.samplesPerReplicate(header.replicates);
    return header;
}

// Of a part the checkpoint is the file that is wanted in the end.
ExitCode RenderRun::openCheckpoint(PixelFilm& film, RenderState& state) {
    const CheckpointOptions& options = options_.checkpoint;
    if (options.off && !options.resume && !options_.part) return ExitCode::done;
    const std::string path = options_.part ? summary_.image : summary_.image + ".ckpt";
    checkpoint_.emplace(path, checkpointHeader(), [this] { return identity(); });
    if (options.resume && checkpoint_->exists()) {
        try {
            state = checkpoint_->resume(film.planes());
        } catch (const CheckpointFault& fault) {
            return refuse(fault.code.c_str(), fault.what(), fault.help, ExitCode::faulty);
        }
    } else if (options.resume) {
        warn("W0664", fmt::format("there is no checkpoint `{}`; the render begins anew", path), {});
    } else if (!options_.part && checkpoint_->exists()) {
        warn("W0663", fmt::format("`{}` holds an earlier state of a render; this one will replace it", path),
             "`--resume` goes on with it");
    }
    checkpoint_->writeOnlyIf([this] { return texturesReadable(); });
    checkpoint_->start(film.planes(), state, options.off ? 0 : options.interval);
    return ExitCode::done;
}

void RenderRun::warn(const char* code, std::string message, std::string help) {
    Diagnostics diagnostics;
    diagnostics.warning(code, {}, std::move(message)).help = std::move(help);
    report_->diagnostics(diagnostics, loaded_->sources);
    ++summary_.warnings;
}

// What is rendered without a texture that was there is worth nothing, and must not get into a checkpoint.
bool RenderRun::texturesReadable() const {
    Diagnostics found;
    for (const auto& texture : built_.scene.textures) texture->reportLookups(found);
    return std::none_of(found.all().begin(), found.all().end(), [](const Diagnostic& d) { return d.code == "W0458"; });
}

// Once a second, and at the end.
void RenderRun::watchTextures(InterruptGuard& interrupt, const Progress& p) {
    if (lostTexture_ || (p.fraction < 1 && p.elapsed < watchedUntil_ + 1)) return;
    watchedUntil_ = p.elapsed;
    lostTexture_ = !texturesReadable();
    if (lostTexture_) interrupt.requestStop();
}

// Of writing in the background.
void RenderRun::tellFault() {
    const auto fault = checkpoint_ ? checkpoint_->takeFault() : std::nullopt;
    if (fault) warn("W0662", fmt::format("the checkpoint was not written: {}", *fault), "the render goes on");
}

void RenderRun::renderFrom(PixelFilm& film, RenderState& state, InterruptGuard& interrupt) {
    const auto progress = [this, &interrupt](const Progress& p) {
        tellFault();
        watchTextures(interrupt, p);
        report_->progress(p);
    };
    const auto onSnapshot = [&](const RenderStatistics& statistics) { snapshot(film, statistics); };
    const RenderControl control{&interrupt.stop(), progress, &state, &interrupt.snapshot(), onSnapshot};
    try {
        summary_.statistics = integrator_->render(built_.scene, film, settings_, control);
    } catch (const std::bad_alloc&) {
        // A tile in hand may be in the film in part: good enough for the image, which says that it is partial, but not
        // to go on from. The checkpoint stays as it was written last.
        outOfMemory_ = true;
        checkpoint_.reset();
        summary_.statistics.stopped = true;
        summary_.statistics.samplesPerPixel = (state.reached() - state.first()) * built_.render.replicates;
        summary_.statistics.examples = state.examples();
    }
}

void RenderRun::render(PixelFilm& film, RenderState& state, InterruptGuard& interrupt) {
    report_->start({options_.input.path, summary_.image, film_.crop.width(), film_.crop.height(), threadCount(),
                    settings_.samples, settings_.noiseTarget, settings_.timeLimit});
    watch_.lap();
    renderFrom(film, state, interrupt);
    summary_.partial = summary_.statistics.stopped || lostTexture_;
    summary_.statistics.stopped = summary_.partial;
    closeCheckpoint();
    endPhase("rendering", watch_.lap());
    summary_.noise = film.relativeNoise();
}

// What is most dear is saved first: the image can be made from it.
void RenderRun::closeCheckpoint() {
    if (!checkpoint_) return;
    checkpoint_->stop();
    tellFault();
    if (options_.part) {
        checkpoint_->save();
        report_->image(summary_.image, summary_.partial);
        return;
    }
    if (!summary_.partial && !options_.checkpoint.keep) return; // it goes when the image is there
    if (options_.checkpoint.off) return;
    try {
        checkpoint_->save();
    } catch (const IoError& e) {
        warn("W0662", fmt::format("the checkpoint was not written: {}", e.what()), "the image follows");
    }
}

void RenderRun::tellHowToResume() const {
    if (options_.quiet) return;
    common_.console.line(
        fmt::format("to go on:  {}{}", common_.commandLine, options_.checkpoint.resume ? "" : " --resume"));
}

// In the middle of a render that goes on; whatever fails is told and no reason to end it.
void RenderRun::snapshot(const PixelFilm& film, const RenderStatistics& statistics) {
    const RenderStatistics before = std::exchange(summary_.statistics, statistics);
    try {
        if (checkpoint_) checkpoint_->save();
        if (!options_.part) {
            Diagnostics ignored; // told at the end
            summary_.partial = true;
            summary_.noise = film.relativeNoise();
            const FilmPicture picture = pictureOf(film);
            writeImage(summary_.image, picture, film_, attributes(film), ignored);
            report_->image(summary_.image, true);
            writePng(picture.image);
        }
    } catch (const IoError& e) {
        warn("W0662", fmt::format("the snapshot was not written: {}", e.what()), "the render goes on");
    }
    summary_.partial = false;
    summary_.statistics = before;
}

std::vector<ImageAttribute> RenderRun::attributes(const PixelFilm& film) const {
    double seconds = 0;
    for (const auto& phase : summary_.phases) seconds += phase.second;
    auto list =
        provenance({loaded_.get(), &options_.input, &built_, &settings_, &summary_.statistics, common_.commandLine,
                    std::string(spaceName(film_.space)), summary_.noise, seconds, film.replicates()});
    for (ImageAttribute& a : viewIdentity(options_.view)) list.push_back(std::move(a));
    if (!options_.parts.empty()) list.push_back({"abbe.parts", static_cast<int>(options_.parts.size())});
    return list;
}

void RenderRun::writePng(const ResolvedImage& image) {
    if (summary_.png.empty()) return;
    DisplayPicture picture{image.bounds.width(), image.bounds.height(), {}, film_.space};
    picture.rgb.reserve(3 * image.r.size());
    for (std::size_t i = 0; i < image.r.size(); ++i)
        picture.rgb.insert(picture.rgb.end(), {image.r[i], image.g[i], image.b[i]});
    writeDisplayPng(summary_.png, std::move(picture), options_.view, 8);
    report_->image(summary_.png, summary_.partial);
}

void RenderRun::write(const PixelFilm& film) {
    const FilmPicture picture = pictureOf(film);
    Diagnostics warnings;
    try {
        writeImage(summary_.image, picture, film_, attributes(film), warnings);
    } catch (const IoError& e) {
        writeRescued(picture, attributes(film), e);
    }
    report_->image(summary_.image, summary_.partial);
    writePng(picture.image);
    endPhase("writing", watch_.lap());
    warnOfDroppedSamples(summary_.statistics, warnings);
    warnOfDensities(summary_.statistics.excess, warnings);
    for (const auto& texture : built_.scene.textures) texture->reportLookups(warnings);
    warnOfBlackImage(picture.image, warnings);
    report_->diagnostics(warnings, loaded_->sources);
    summary_.warnings += warnings.warningCount();
}

// Parts that were rendered elsewhere, as if it had been here.
ExitCode RenderRun::merge() {
    try {
        RenderParts parts(options_.parts);
        parts.check(identity());
        film_.crop = parts.bounds();
        PixelFilm film = makeFilm(film_.crop);
        watch_.lap();
        summary_.statistics = parts.addTo(film.planes());
        summary_.noise = film.relativeNoise();
        endPhase("merging", watch_.lap());
        write(film);
    } catch (const CheckpointFault& fault) {
        return refuse(fault.code.c_str(), fault.what(), fault.help, ExitCode::faulty);
    }
    return finish(0);
}

// The disk filled up or went away while rendering: what was computed is saved where temporary files go, and a
// checkpoint beside the image if there is room for that.
void RenderRun::writeRescued(const FilmPicture& picture, std::vector<ImageAttribute> attributes, const IoError& why) {
    const auto rescued = std::filesystem::temp_directory_path() / std::filesystem::path(summary_.image).filename();
    std::string saved;
    try {
        Diagnostics ignored;
        writeImage(rescued.string(), picture, film_, std::move(attributes), ignored);
        saved = fmt::format("; the image was saved as `{}`", rescued.string());
    } catch (const IoError&) {
        saved = "; nor is there room in the folder of temporary files";
    }
    if (checkpoint_) {
        try {
            checkpoint_->save();
            saved += fmt::format("; the render was saved as `{}`", checkpoint_->path());
        } catch (const IoError&) {
            if (checkpoint_->writes() > 0)
                saved += fmt::format("; an earlier state of the render is in `{}`", checkpoint_->path());
        }
    }
    throw IoError(why.what() + saved);
}

ExitCode RenderRun::finish(int signal) {
    summary_.exit = ExitCode::done;
    if (options_.strict && summary_.warnings > 0) summary_.exit = ExitCode::threshold;
    if (outOfMemory_)
        summary_.exit = refuse("E0665", fmt::format("memory ran out; the image so far is in `{}`", summary_.image),
                               "give it more memory, fewer layers, or a smaller `crop`", ExitCode::memory);
    if (lostTexture_)
        summary_.exit = refuse("E0666",
                               fmt::format("a texture could not be read any more (W0458), so the render was ended; the "
                                           "image so far is in `{}`, black where the texture should be",
                                           summary_.image),
                               checkpoint_ && checkpoint_->writes() > 0
                                   ? "the checkpoint is of before that: bring the file back and go on with `--resume`"
                                   : "bring the file back and render again",
                               ExitCode::faulty);
    if (signal != 0) summary_.exit = static_cast<ExitCode>(128 + signal);
    if (checkpoint_ && summary_.partial && !options_.checkpoint.off)
        tellHowToResume();
    else if (checkpoint_ && !options_.part && !options_.checkpoint.keep)
        checkpoint_->remove();
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
