// What a render tells while it goes on, for people or for machines.
#pragma once

#include "app/console.h"
#include "app/frame_list.h"
#include "app/program_end.h"
#include "cameras/exposure.h"
#include "film/error_certificate.h"
#include "pictures/picture_figures.h"
#include "render/integrator.h"
#include "reports/sample_report.h"
#include "study/cost.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace abbe {

// Known before the first sample.
struct RenderStart {
    std::string scene, image; // paths
    int width = 0, height = 0;
    int threads = 0;
    std::uint32_t samples = 0;
    double noiseTarget = 0, timeLimit = 0; // 0: none
    double time = 0;                       // s, when the shutter opens
};

// Known at the end.
struct RenderSummary {
    std::string image, deep, png; // paths; empty: none
    std::string space;            // of the image
    int width = 0, height = 0;
    bool partial = false;
    std::vector<std::pair<std::string, double>> phases; // name, seconds
    double totalSeconds = 0;
    RenderStatistics statistics;
    double noise = 0;                            // relative error of what was written
    std::vector<FoundFault> faults;              // of the examples of dropped samples, unless interrupted
    std::optional<ErrorCertificate> certificate; // of that
    std::optional<SampleSpread> spread;          // of an adaptive render
    std::optional<PictureFigures> figures;       // of the picture, if one was made
    Exposure exposure;                           // of its camera
    std::optional<CostReport> cost;              // of all of it
    std::uint64_t memoryBytes = 0;
    std::size_t warnings = 0;
    ExitCode exit = ExitCode::done;
};

// Calls come in order from one thread at a time; progress() may come from a worker.
class RenderReport {
  public:
    virtual ~RenderReport() = default;
    virtual void start(const RenderStart&) = 0;
    virtual void phase(const std::string& name, double seconds) = 0; // after it ended
    virtual void progress(const Progress&) = 0;
    virtual void image(const std::string& path, bool partial) = 0; // after it was written
    virtual void preview(const std::string& path) = 0;             // likewise; it goes when the image is there
    virtual void diagnostics(const Diagnostics&, const SourceMap&) = 0;
    virtual void done(const RenderSummary&) = 0;
};

// A bar on a terminal, else a line per tenth or half minute; a summary at the end. Quiet: diagnostics alone.
std::unique_ptr<RenderReport> makeHumanReport(const Console&, bool quiet, const std::optional<FrameOfRun>& = {});
// One JSON object a line on stdout; docs/command_line.md lists the events.
std::unique_ptr<RenderReport> makeJsonReport(const Console&, const std::optional<FrameOfRun>& = {},
                                             double secondsBetweenProgress = 0.25);

} // namespace abbe
