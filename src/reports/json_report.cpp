#include "reports/image_header.h"
#include "reports/progress.h"
#include "reports/render_report.h"
#include "reports/render_text.h"
#include "reports/sample_report.h"

#include <limits>

namespace abbe {

namespace {

Json positiveOrNull(double v) { return v > 0 ? Json(v) : Json(); }

Json faultsJson(const std::vector<FoundFault>& faults) {
    Json list = Json::list();
    for (const FoundFault& f : faults) list.push(faultJson(f));
    return list;
}

class JsonReport final : public RenderReport {
  public:
    JsonReport(const Console& console, const std::optional<FrameOfRun>& frame, double every)
        : console_(console), frame_(frame), every_(every) {}

    void start(const RenderStart& s) override {
        Json event = Json::object({{"event", "start"},
                                   {"scene", s.scene},
                                   {"image", s.image},
                                   {"width", s.width},
                                   {"height", s.height},
                                   {"threads", s.threads},
                                   {"samples", s.samples},
                                   {"noise_goal", positiveOrNull(s.noiseTarget)},
                                   {"time_limit_s", positiveOrNull(s.timeLimit)}});
        if (frame_)
            event.set("frame_time_s", s.time)
                .set("frame_position", static_cast<std::uint64_t>(frame_->position))
                .set("frame_count", static_cast<std::uint64_t>(frame_->count));
        emit(std::move(event));
    }

    void phase(const std::string& name, double seconds) override {
        emit(Json::object({{"event", "phase"}, {"name", name}, {"seconds", seconds}}));
    }

    // So often at most, and the end.
    void progress(const Progress& p) override {
        if (p.fraction < 1 && p.elapsed - lastShown_ < every_) return;
        lastShown_ = p.elapsed;
        emit(Json::object({{"event", "progress"},
                           {"done", p.fraction},
                           {"pass", p.pass + 1},
                           {"spp", p.samplesPerPixel},
                           {"noise", positiveOrNull(p.noise)},
                           {"rate", p.pathsPerSecond},
                           {"elapsed_s", p.elapsed},
                           {"core_s", p.coreSeconds},
                           {"eta_s", knowsTimeLeft(p) ? Json(p.left) : Json()}}));
    }

    void image(const std::string& path, bool partial) override {
        emit(Json::object({{"event", "image"}, {"path", path}, {"partial", partial}}));
    }

    void preview(const std::string& path) override {
        emit(Json::object({{"event", "image"}, {"path", path}, {"partial", true}, {"preview", true}}));
    }

    void diagnostics(const Diagnostics&, const SourceMap&) override;

    void done(const RenderSummary& s) override {
        const RenderStatistics& r = s.statistics;
        std::uint64_t dropped = 0;
        for (const std::uint64_t n : r.dropped) dropped += n;
        Json event = Json::object({{"event", "done"},
                                   {"exit", static_cast<int>(s.exit)},
                                   {"partial", s.partial},
                                   {"seconds", s.totalSeconds},
                                   {"render_seconds", r.seconds},
                                   {"core_seconds", r.coreSeconds + r.pilotCoreSeconds},
                                   {"spp", r.samplesPerPixel},
                                   {"paths", r.paths},
                                   {"rays", r.rays()},
                                   {"pilot_rays", r.pilotRays},
                                   {"pilot_seconds", r.pilotSeconds},
                                   {"pilot_core_seconds", r.pilotCoreSeconds},
                                   {"noise", positiveOrNull(s.noise)},
                                   {"error", s.certificate ? certificateJson(*s.certificate) : Json()},
                                   {"picture", s.figures ? pictureJson(*s.figures, s.exposure) : Json()},
                                   {"kernel", r.kernel},
                                   {"memory_bytes", s.memoryBytes},
                                   {"dropped", dropped},
                                   {"dropped_samples", faultsJson(s.faults)},
                                   {"densities_above_bound", r.excess.above},
                                   {"cost", s.cost ? costJson(*s.cost) : Json()},
                                   {"warnings", static_cast<std::uint64_t>(s.warnings)}});
        for (const auto& c : countersOf(r))
            if (c.reported != Reported::always && isReported(c, r)) event.set(c.name, *c.place);
        if (r.caustics.of<LightPathFindings>().verdict != LightPathVerdict::undecided)
            event.set("light_path_plan", lightPathJson(r.caustics));
        if (r.caustics.of<GuideFindings>().verdict != GuideFindings::Verdict::undecided)
            event.set("guiding", guideJson(r.caustics.of<GuideFindings>()));
        addLook(event, r.look);
        if (s.spread)
            event.set("spp_least", s.spread->least).set("spp_most", s.spread->most).set("spp_mean", s.spread->mean);
        emit(std::move(event));
    }

  private:
    void emit(Json event) const {
        if (frame_) event.set("frame", frame_->number);
        console_.data(event.text() + "\n");
    }

    Console console_;
    std::optional<FrameOfRun> frame_;
    double every_;                                                // s
    double lastShown_ = -std::numeric_limits<double>::infinity(); // s
};

void JsonReport::diagnostics(const Diagnostics& list, const SourceMap& sources) {
    for (const Diagnostic& d : list.all()) {
        Json event = Json::object(
            {{"event", d.severity == Severity::error ? "error" : "warning"}, {"code", d.code}, {"message", d.message}});
        if (d.span.valid()) {
            const LineColumn at = sources.lineColumn(d.span.file, d.span.begin);
            event.set("path", sources.path(d.span.file)).set("line", at.line).set("column", at.column);
        }
        if (!d.help.empty()) event.set("help", d.help);
        emit(std::move(event));
    }
}

} // namespace

std::unique_ptr<RenderReport> makeJsonReport(const Console& console, const std::optional<FrameOfRun>& frame,
                                             double secondsBetweenProgress) {
    return std::make_unique<JsonReport>(console, frame, secondsBetweenProgress);
}

} // namespace abbe
