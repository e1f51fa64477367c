#include "reports/image_header.h"
#include "reports/progress.h"
#include "reports/render_report.h"
#include "reports/render_text.h"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace abbe {

namespace {

class HumanReport final : public RenderReport {
  public:
    HumanReport(const Console& console, bool quiet, const std::optional<FrameOfRun>& frame)
        : console_(console), quiet_(quiet), frame_(frame) {}
    ~HumanReport() override { clearBar(); }

    void start(const RenderStart& s) override {
        started_ = true;
        noiseTarget_ = s.noiseTarget;
        if (quiet_) return;
        if (frame_) console_.line(fmt::format("{}: number {}, at {:.6g} s", frame_->text(), frame_->number, s.time));
        console_.line(fmt::format("{}  {}×{}  {} thread{}  image {}", s.scene, s.width, s.height, s.threads,
                                  s.threads == 1 ? "" : "s", s.image));
    }

    void phase(const std::string& name, double seconds) override {
        clearBar();
        if (quiet_ || started_ || seconds < 1) return; // short ones are in the summary alone
        console_.line(fmt::format("{} {:.1f} s", name, seconds));
    }

    void progress(const Progress& p) override {
        if (quiet_) return;
        console_.interactive() ? showBar(p) : showLine(p);
    }

    void image(const std::string& path, bool partial) override {
        clearBar();
        if (!quiet_ && partial) console_.line(fmt::format("{} holds the image so far", path));
    }

    void preview(const std::string& path) override {
        if (quiet_ || std::exchange(previewTold_, true)) return;
        clearBar();
        console_.line(fmt::format("{} shows what there is so far", path));
    }

    void diagnostics(const Diagnostics& d, const SourceMap& sources) override {
        clearBar();
        console_.report(frame_ && frame_->told ? unheard(d) : d, sources);
    }

    void done(const RenderSummary&) override;

  private:
    // Four times a second, after a minute once a second.
    void showBar(const Progress& p) {
        if (p.elapsed - lastShown_ < (p.elapsed < 60 ? 0.25 : 1.0)) return;
        lastShown_ = p.elapsed;
        const std::string frame = ofFrame();
        const int width = std::max(10, console_.width() - static_cast<int>(frame.size()));
        if (console_.status(frame + progressBar(p, noiseTarget_, width))) barShown_ = true;
    }

    void showLine(const Progress& p) {
        const int tenth = static_cast<int>(10 * p.fraction);
        const double since = p.elapsed - lastShown_;
        if (since < 2 || (tenth <= lastTenth_ && since < 30)) return;
        lastTenth_ = tenth;
        lastShown_ = p.elapsed;
        console_.line(ofFrame() + progressLine(p, noiseTarget_));
    }

    // Without warnings that an earlier frame gave.
    Diagnostics unheard(const Diagnostics& list) const {
        Diagnostics fresh;
        for (const Diagnostic& d : list.all())
            if (d.severity == Severity::error ||
                frame_->told->insert(fmt::format("{} {} {} {}", d.code, d.span.begin, d.message, d.label)).second)
                fresh.add(d);
        return fresh;
    }

    std::string ofFrame() const { return frame_ ? frame_->text() + "  " : std::string(); }

    void clearBar() {
        if (!barShown_) return;
        console_.clearStatus();
        barShown_ = false;
    }

    Console console_;
    bool quiet_;
    std::optional<FrameOfRun> frame_;
    double noiseTarget_ = 0;
    double lastShown_ = 0;
    int lastTenth_ = 0;
    bool started_ = false; // rendering
    bool barShown_ = false;
    bool previewTold_ = false;
};

void HumanReport::done(const RenderSummary& s) {
    clearBar();
    if (quiet_) return;
    const RenderStatistics& r = s.statistics;
    std::string phases;
    for (const auto& [name, seconds] : s.phases) phases += fmt::format("{} {:.2f} s   ", name, seconds);
    console_.line(fmt::format("  {}total {:.2f} s", phases, s.totalSeconds));
    const double rate = r.seconds > 0 ? static_cast<double>(r.paths) / r.seconds : 0;
    console_.line(fmt::format("  {}paths   {}rays   {}paths/s   {} samples per pixel   kernel {}",
                              countText(static_cast<double>(r.paths)), countText(static_cast<double>(r.rays())),
                              countText(rate), r.samplesPerPixel, r.kernel));
    if (r.lightPaths > 0) {
        std::string line;
        for (const auto& c : countersOf(r))
            if (c.reported == Reported::withLightPaths)
                line += fmt::format("{}{}{}", line.empty() ? "  " : "   ", countText(static_cast<double>(*c.place)),
                                    c.unit);
        console_.line(line);
    }
    const auto& lightPaths = r.caustics.of<LightPathFindings>();
    if (lightPaths.measured || lightPaths.verdict == LightPathVerdict::noPilot)
        console_.line("  " + lightPathLine(lightPaths));
    if (const std::string line = manifoldLine(r.caustics); !line.empty()) console_.line("  " + line);
    if (const std::string line = mergeLine(r.caustics.of<MergeFindings>()); !line.empty()) console_.line("  " + line);
    if (const std::string line = guideLine(r.caustics.of<GuideFindings>()); !line.empty()) console_.line("  " + line);
    if (const std::string line = glintLine(r.caustics.of<GlintFindings>()); !line.empty()) console_.line("  " + line);
    if (r.manifoldCapped > 0)
        console_.line(fmt::format("  {} of {} estimates by manifold sampling were capped, and too low",
                                  r.manifoldCapped, r.manifoldEstimates));
    if (s.spread) console_.line(fmt::format("  samples of pixels {}", s.spread->text()));
    if (s.figures) console_.line("  " + pictureLine(*s.figures));
    if (s.figures && s.exposure.automatic)
        console_.line(fmt::format("  exposure auto is {0:.1f} stops: `exposure {0:.1f} stops` keeps it, in animations "
                                  "for example",
                                  s.exposure.stops));
    if (s.certificate) console_.line("  " + certificateLine(*s.certificate));
    if (s.certificate && s.certificate->merged) console_.line("  " + mergedLine(*s.certificate->merged));
    console_.line(
        fmt::format("  memory {} MB   {} warning{}", s.memoryBytes / 1000000, s.warnings, s.warnings == 1 ? "" : "s"));
    if (r.excess.above > 0)
        console_.line(fmt::format("  {} of {} densities of media above their bound, at most {:.3g} times",
                                  countText(static_cast<double>(r.excess.above)),
                                  countText(static_cast<double>(r.excess.lookups)), r.excess.most));
    if (s.image.empty()) return;
    console_.line(
        fmt::format("image {}{}  {}×{} {}", s.image, s.partial ? " (partial)" : "", s.width, s.height, s.space));
    for (const std::string& path : {s.deep, s.png})
        if (!path.empty()) console_.line(fmt::format("image {}", path));
    if (!s.png.empty() && console_.interactive()) console_.line(viewingLine(s.png));
}

} // namespace

std::unique_ptr<RenderReport> makeHumanReport(const Console& console, bool quiet,
                                              const std::optional<FrameOfRun>& frame) {
    return std::make_unique<HumanReport>(console, quiet, frame);
}

} // namespace abbe
