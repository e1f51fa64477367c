// The interface of integrators, which turn a scene into an image: settings, control, statistics, findings.
#pragma once

#include "render/film.h"
#include "render/path_tally.h"
#include "render/technique.h"

#include <algorithm>
#include <any>
#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace abbe {

// What was found out before a render about light that camera paths find seldom or never, for people to read. One record
// for each technique, of a type of the technique's own (LightPathFindings, …). All of it depends on the scene, the
// frame, the pixel filter, the seed and the size of the pilots alone.
class CausticFindings {
  public:
    int pilot = 0; // the size of the pilots: RenderSettings::pilot; 0: none

    // As it is by default where that technique has told nothing.
    template <typename Record> const Record& of() const {
        for (const std::any& record : records_)
            if (const auto* found = std::any_cast<Record>(&record)) return *found;
        static const Record kNothing;
        return kNothing;
    }
    template <typename Record> Record& of() {
        for (std::any& record : records_)
            if (auto* found = std::any_cast<Record>(&record)) return *found;
        return std::any_cast<Record&>(records_.emplace_back(Record()));
    }

  private:
    std::list<std::any> records_; // which stay where they are, for who holds a reference
};

class Shape;

// Paths that surfaces take no light from, so that chance alone ends them (PathWalk::longPathSurvival).
struct EndlessPaths {
    double share = 0; // of the paths where they are the longest
    std::vector<const Shape*>
        shapes; // between which they go, those that are hit most often first; empty: there are none
};

// A rough picture of the frame before the first sample. The frame in square cells, row by row, of a few samples each.
// For people to see while plans are made: no sample of it is in the image.
struct FramePreview {
    PixelBounds frame;
    int cellSize = 1; // pixels; cells at the right and lower borders may be cut
    int columns = 0, rows = 0;
    std::vector<Xyz> cells;
    double secondsForSample = 0; // of the clock, that a sample of every pixel of the frame takes, as far as this tells
    double raysOfPath = 0;       // in the mean over the frame
    EndlessPaths endless = {};

    // Of a pixel; beyond the frame, of the cell next to it. Requires a cell.
    const Xyz& at(int x, int y) const {
        const int column = std::clamp((x - frame.x0) / cellSize, 0, columns - 1);
        const int row = std::clamp((y - frame.y0) / cellSize, 0, rows - 1);
        return cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                     static_cast<std::size_t>(column)];
    }
};

struct Scene;
class RenderState;

// Half-open, of the samples of each replicate.
struct SampleRange {
    std::uint32_t first = 0, last = 0;
};

// The numbers a render is asked for. Defaults are documented in the schema of `render`.
struct RenderSettings {
    static constexpr int kFullPilot = 4, kGuidePilot = 10, kMostPilot = 34, kPilotByWork = -1;

    std::uint32_t samples = 64; // per pixel, all replicates together; rounded up to a multiple of the replicates
    std::uint64_t seed = 0;
    std::uint32_t maxDepth = 0;        // 0: no limit
    double noiseTarget = 0;            // relative error at which to stop (0.005 for 0.5 %); 0: none
    double timeLimit = 0;              // s; 0: none
    std::uint32_t part = 1, parts = 1; // which of so many equal ranges of the samples is taken,
    std::uint32_t skip = 0;            // behind the first so many per pixel, a multiple of the replicates
    // Wavelengths as in a scene with dispersion, whether or not this one has it: for comparing the two.
    bool asIfDispersive = false;
    bool adaptive = false; // more samples where a pilot of the frame finds more noise, fewer elsewhere
    // How large the pilots are by which light paths, merging and what else serves caustics are planned: 0 (none, and no
    // such plan) to kFullPilot, each four times the work of the one before. kPilotByWork: the largest that take no more
    // than a tenth of the rays of the whole render, and of the time limit; but for that size 1 at least. And
    // kGuidePilot times the size of those by which paths are guided, 0 to 3: kMostPilot is the largest of both.
    int pilot = kFullPilot;
    Technique technique = {};

    // Of the whole render.
    std::uint32_t samplesPerReplicate(int replicates) const {
        const auto r = static_cast<std::uint64_t>(replicates);
        return static_cast<std::uint32_t>(std::max<std::uint64_t>(1, (samples + r - 1) / r));
    }
    // Of this part of it. Requires 1 <= part <= parts and skip below samples.
    SampleRange range(int replicates) const {
        const std::uint64_t begin = skip / static_cast<std::uint32_t>(replicates);
        const std::uint64_t all = samplesPerReplicate(replicates) - begin;
        return {static_cast<std::uint32_t>(begin + all * (part - 1) / parts),
                static_cast<std::uint32_t>(begin + all * part / parts)};
    }
};

// One sample of a render, which can be repeated by itself: `abbe replay … --pixel x,y --sample replicate:index`.
struct SampleId {
    int x = 0, y = 0;
    int replicate = 0;
    std::uint32_t index = 0;
};

struct DroppedSample : SampleId {
    DropCause cause = DropCause::nan;
};

// How paths are drawn because of what the look at the frame found (docs/decisions/015-light-tree.md and
// docs/performance.md, "Towards the surface").
struct LookFindings {
    bool lightsByArrival = false;                          // how much of them arrives has a say in their choice
    std::vector<std::pair<std::string, float>> walks = {}; // media of solids, and the share drawn to the surface
};

// What a render came to.
struct RenderStatistics : PathTally {
    CausticFindings caustics; // by which it was decided how light is found
    LookFindings look;
    std::uint64_t manifoldEstimates = 0, manifoldTrials = 0, manifoldCapped = 0; // of this run alone
    std::uint64_t pilotRays = 0;                   // of looks ahead that are not in the image, of this run alone
    double pilotSeconds = 0;                       // wall clock of these
    double pilotCoreSeconds = 0;                   // of all threads for these; not in coreSeconds, which samples took
    std::uint32_t samplesPerPixel = 0;             // finished in all pixels; adaptive: as if they were even
    std::vector<DroppedSample> examples;           // the first few
    std::map<const void*, std::uint64_t> cappedIn; // of this run alone: in which shapes or media, roughly how many
    double seconds = 0;                            // wall clock, with that of earlier runs
    double noise = 0;                              // estimated relative error of the image
    bool stopped = false;                          // by the caller
    std::string kernel;                            // the instantiation that ran, e.g. "dispersion+absorption"
};

struct Progress {
    double fraction = 0; // of the work that will end the render
    std::uint32_t pass = 0;
    std::uint32_t samplesPerPixel = 0, totalSamples = 0;
    double noise = 0;              // relative; 0 while unknown
    double pathsPerSecond = 0;     // all threads
    double coreSeconds = 0;        // summed over threads, with those of earlier runs
    double elapsed = 0, left = -1; // s; left < 0: unknown yet
};

// How a caller watches, ends and continues a render. Functions are called from the calling thread or from workers, one
// at a time.
struct RenderControl {
    const std::atomic<bool>* stop = nullptr;            // set: leave what is in hand and return
    std::function<void(const Progress&)> progress = {}; // a few times a second
    // Where the render begins, in step with the film given beside it; changed as it goes on. Null: at nothing.
    RenderState* state = nullptr;
    // Set by anyone to have takeSnapshot called between two portions of tiles, with no thread at work on the film, once
    // there are samples; the render then goes on. Both or neither.
    std::atomic<bool>* snapshot = nullptr;
    std::function<void(const RenderStatistics&)> takeSnapshot = {};
    // From the calling thread: once, before the first sample and before anything is planned; and after each pass, with
    // no thread at work on the film.
    std::function<void(const FramePreview&)> framePreview = {};
    std::function<void()> passEnded = {};
};

// An algorithm that turns a scene into an image.
class Integrator {
  public:
    virtual ~Integrator() = default;
    virtual RenderStatistics render(const Scene&, Film&, const RenderSettings&, const RenderControl&) const = 0;
    // Takes samples again, one after the other, each to the bits that it has in a render with these settings and this
    // number of replicates; with each the samples of the same index in the pixel's other replicates.
    virtual void repeat(const Scene&, Film&, const RenderSettings&, std::span<const SampleId>) const = 0;
    // Blocks of light paths that a RenderState for this must have; if any, the film is to take splats. Else there will
    // be no paths of light.
    virtual std::size_t lightBlocks(const Scene&, const RenderSettings&) const { return 0; }
    // Whether the film is to take merged light, too; only if there are such blocks.
    virtual bool merges(const Scene&, const RenderSettings&) const { return false; }
    // By what render() decides how caustics of the scene's whole frame are found, without rendering. Takes a fraction
    // of a second where it has to look. The film tells the pixel filter and the number of replicates alone.
    virtual CausticFindings findCaustics(const Scene&, const Film&, const RenderSettings&) const = 0;
};

} // namespace abbe
