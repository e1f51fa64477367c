// Two estimators of one scene, from the command line to the verdict.
#include "app/interrupt.h"
#include "app/measured_scene.h"
#include "app/options.h"
#include "app/render_report.h"
#include "app/study_progress.h"
#include "app/verify_text.h"
#include "base/stopwatch.h"
#include "verify/verify_run.h"

#include <fmt/format.h>

namespace abbe {

namespace {

constexpr int kVerifySide = 96; // pixels, of a picture whose size nobody asked for

class VerifyCommand {
  public:
    VerifyCommand(const VerifyOptions& options, const CommonOptions& common)
        : options_(options), common_(common),
          messages_(common.json ? makeJsonReport(common.console) : makeHumanReport(common.console, true)),
          scene_(loadMeasured(options.input, options.build, kVerifySide, *messages_)) {}

    ExitCode run() {
        if (scene_.code != ExitCode::done) return scene_.code;
        InterruptGuard interrupt;
        const auto report = measure(interrupt);
        if (!report) {
            say("interrupted; nothing is known yet");
            return static_cast<ExitCode>(128 + interrupt.signal());
        }
        const bool warned = warnOf(*report);
        const VerifyFacts facts{options_.input.path, &scene_.built.scene, subjectSize()};
        common_.console.data(common_.json ? verifyJson(*report, facts) + "\n" : verifyText(*report, facts));
        return !report->agreement.agrees() || (options_.strict && warned) ? ExitCode::threshold : ExitCode::done;
    }

  private:
    std::optional<VerifyReport> measure(InterruptGuard&);
    Vec2i subjectSize() const {
        const FilmSettings film = filmSettings(scene_.built.film);
        return {film.width, film.height};
    }
    // False if there is nothing to warn of.
    bool warnOf(const VerifyReport&) const;
    void say(const std::string& line) const {
        if (!options_.quiet && !common_.json) common_.console.line(line);
    }

    const VerifyOptions& options_;
    const CommonOptions& common_;
    std::unique_ptr<RenderReport> messages_;
    MeasuredScene scene_;
};

std::optional<VerifyReport> VerifyCommand::measure(InterruptGuard& interrupt) {
    using Form = StudyProgressLine::Form;
    StudyProgressLine line(common_.console, common_.json ? Form::json : options_.quiet ? Form::none : Form::human);
    VerifyPlan plan;
    plan.resolution = options_.resolution;
    plan.timeLimit = options_.timeLimit;
    if (options_.samples) plan.samples = static_cast<std::uint32_t>(*options_.samples);
    plan.level = options_.level;
    plan.seed = renderSettings(scene_.built.render).seed;
    const Stopwatch clock;
    const VerifyControl control{&interrupt.stop(), [&](double fraction) {
                                    StudyProgress p;
                                    p.fraction = fraction;
                                    p.what = fraction > 0 ? "rendering" : "pilot";
                                    p.elapsed = clock.seconds();
                                    line.show(p);
                                }};
    return verify(scene_.built, plan, control);
}

bool VerifyCommand::warnOf(const VerifyReport& r) const {
    Diagnostics all;
    const auto warn = [&all](const char* code, std::string message, const char* help) {
        all.warning(code, {}, std::move(message)).help = help;
    };
    const Agreement& a = r.agreement;
    if (!a.whole.judged)
        warn("W0735", "the picture is too noisy to say anything: single replicates make most of the variance",
             "give it more `--time`");
    else if (r.timeLimited && a.whole.error > options_.resolution)
        warn("W0735",
             fmt::format("the difference is known to {} only, {} was wanted", verifyPercent(a.whole.error),
                         verifyPercent(options_.resolution)),
             "give it more `--time`");
    if (const std::uint64_t dropped = r.sides[0].dropped + r.sides[1].dropped)
        warn("W0734", fmt::format("{} samples were dropped: something in them was not finite, or negative", dropped),
             "`abbe render` of the scene with its samples tells where");
    messages_->diagnostics(all, scene_.loaded->sources);
    return !all.all().empty();
}

} // namespace

ExitCode run(const VerifyOptions& options, const CommonOptions& common) { return VerifyCommand(options, common).run(); }

} // namespace abbe
