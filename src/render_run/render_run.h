// One run of `abbe render` or `abbe merge`.
#pragma once

#include "app/console.h"
#include "app/program_end.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "base/work_clock.h"
#include "checkpoints/render_checkpoint.h"
#include "io/file.h"
#include "pictures/display_view.h"
#include "pictures/image_output.h"
#include "render/integrator.h"
#include "render/render_state.h"
#include "render_run/render_options.h"
#include "render_run/render_preview.h"
#include "reports/render_report.h"
#include "scene/reuse.h"
#include "study/cost.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace abbe {

// A render inside of another program: who hears of it, and gets the picture.
//
// Signals stay the host's, which ends a render by InterruptGuard::requestStopOfAll(). Called from the thread that
// renders, and the report from workers, too.
class RenderHost {
  public:
    virtual ~RenderHost() = default;
    // In place of one on the console. Once.
    virtual std::unique_ptr<RenderReport> report() = 0;
    // The image as it is in the end, also where it is written to files (RenderOptions::inMemory); not of parts.
    virtual void take(HeldImage) = 0;
};

// What the renders of one process have in common, one after another.
struct RenderCarry {
    SceneLoader scenes;
    SceneReuse reuse;
};

// One render from the command line to the files. The phases follow each other and are timed.
class RenderRun {
  public:
    // With a `host` nothing is told on the console, and signals are its own. Takes over what `carry` has of earlier
    // renders, and leaves it what later ones can use; null: nothing.
    RenderRun(const RenderOptions& options, const CommonOptions& common, RenderCarry* carry = nullptr,
              RenderHost* host = nullptr)
        : options_(options), common_(common), carry_(carry), host_(host),
          report_(host ? host->report()
                  : common.json && options.replay.empty()
                      ? makeJsonReport(common.console, options.frame, options.progressEvery)
                      : makeHumanReport(common.console, options.quiet || alone(), options.frame)) {}

    ExitCode run() {
        const WorkScope work(Work::preparing);
        if (!host_) endOnSignals();
        if (const ExitCode code = load(); code != ExitCode::done) return code;
        if (const ExitCode code = prepare(); code != ExitCode::done) return code;
        if (options_.pixel) return renderPixel();
        if (!options_.replay.empty()) return replay();
        if (!options_.parts.empty()) return merge();
        InterruptGuard interrupt(host_ ? InterruptGuard::Signals::left : InterruptGuard::Signals::taken);
        PixelFilm film = makeFilm(film_.crop);
        RenderState state(film.bounds(), settings_.range(film.replicates()).first,
                          integrator_->lightBlocks(built_.scene, settings_));
        if (const ExitCode code = openCheckpoint(film, state); code != ExitCode::done) return code;
        openPreview();
        openTev(film);
        render(film, state, interrupt);
        if (hasPicture_ && !options_.part) writeInMemory(film);
        return hasPicture_ ? finish(interrupt.signal()) : finish(interrupt.signal(), leaveFiles());
    }

    // The file of the image, once run() has come to it.
    const std::string& image() const { return summary_.image; }

  private:
    // Whether nothing is written, but one pixel or a few samples are looked at.
    bool alone() const { return options_.pixel || !options_.replay.empty(); }
    ExitCode load();
    ExitCode prepare();
    ExitCode checkFilm();
    void warnOfDeepMemory();
    ExitCode checkOutputs();
    ExitCode checkSkip();
    void warnOfFrames();
    ExitCode refuse(std::string_view code, std::string message, std::string help, ExitCode exit);
    // `layerRows`: the film has the layers of these rows alone.
    PixelFilm makeFilm(PixelBounds bounds, std::optional<PixelBounds> layerRows = {}) const {
        PixelFilm film(bounds, PixelFilter(film_.filter, film_.filterRadius),
                       static_cast<int>(built_.render.replicates));
        film.keepSplatsOf(*integrator_, built_.scene, settings_);
        if (!alone())
            film.keepLayers(built_.layers, built_.scene.names, rgbSpace(film_.space),
                            {built_.scene.intersector.get(), built_.scene.camera.get()}, layerRows);
        return film;
    }
    ExitCode renderPixel();
    ExitCode replay();
    ExitCode checkMemory();
    double memoryBudget() const; // bytes
    double filmBytes() const;
    PixelBounds layersAtOnce() const; // pixels whose layers are in memory
    std::string replayCommand() const;
    void findDropped(const Film&);
    ExitCode merge();
    ExitCode openCheckpoint(PixelFilm&, RenderState&);
    CheckpointHeader checkpointHeader() const;
    std::vector<Fact> identity() const;
    void render(PixelFilm&, RenderState&, InterruptGuard&);
    void renderFrom(PixelFilm&, RenderState&, InterruptGuard&);
    void snapshot(const PixelFilm&, const RenderStatistics&);
    void closeCheckpoint();
    void savePart();
    void tellFault();
    bool texturesReadable() const;
    void watch(InterruptGuard&, const Progress&);
    void tellHowToResume() const;
    void warn(const char* code, std::string message, std::string help);
    void certify(const PixelFilm&);
    void writeCertificate();
    void write(const PixelFilm&);
    void writeFiles(const PixelFilm&, FilmPicture&, Diagnostics&);
    void writeInMemory(const PixelFilm&);
    ExitCode refuseForMemory();
    std::vector<ImageAttribute> attributes(const PixelFilm&);
    CostReport cost();
    void meter();
    ExitCode checkPng();
    void writePng(const ResolvedImage&);
    void judgePicture(const PixelFilm&, const ResolvedImage&, Diagnostics&);
    // Nothing if there is no such view, with the reason.
    std::optional<DisplayView> displayView(std::string& reason) const;
    void writeRescued(FilmPicture&, std::vector<ImageAttribute>, const IoError&);
    FilmPicture pictureOf(const PixelFilm&);
    void openPreview();
    void openTev(const PixelFilm&);
    void tellOfTev();
    ExitCode leaveFiles();
    ExitCode finish(int signal, ExitCode otherwise = ExitCode::done);

    void endPhase(const char* name, double seconds) {
        summary_.phases.emplace_back(name, seconds);
        report_->phase(name, seconds);
    }

    const RenderOptions& options_;
    const CommonOptions& common_;
    RenderCarry* const carry_;
    RenderHost* const host_; // or null
    std::unique_ptr<RenderReport> report_;
    std::shared_ptr<LoadedScene> loaded_;
    BuiltScene built_;
    FilmSettings film_;
    RenderSettings settings_;
    std::unique_ptr<const Integrator> integrator_;
    WorkClock clock_{threadCount()}; // outlives whoever reads it: the checkpoint
    WorkReading earlier_;            // of runs and parts before this one
    std::optional<RenderCheckpoint> checkpoint_;
    std::optional<RenderPreview> preview_;
    std::optional<TevFilm> tev_;
    std::optional<FramePreview> look_; // of this run
    BringLayers bringLayers_;          // of parts: the film has those of a few rows at a time
    bool hasSamples_ = true;           // that it was to take, at least one
    bool hasPicture_ = true;           // these, or a first look where the time was up
    std::size_t lookedAt_ = 0;         // pixels that were written without a sample, as they looked at first
    bool allBegun_ = true;             // a sample of every pixel was taken, be it that it was dropped
    bool certificateAlso_ = true;      // no file of somebody else has its name
    bool outOfMemory_ = false;         // while rendering or writing
    bool imageWritten_ = false;        // in the end
    std::string olderCheckpoint_;      // which stays when memory ran out
    std::string shortage_;             // why memory ran out, if it is known
    double beyondBudget_ = 0;          // bytes that were taken when that was too much
    bool lostTexture_ = false;
    double watchedUntil_ = 0; // s, textures and memory
    RenderSummary summary_;
    Stopwatch watch_;
    const Stopwatch whole_; // never lapped
};

} // namespace abbe
