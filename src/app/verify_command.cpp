// Two estimators of one scene, from the command line to the verdict.
#include "app/interrupt.h"
#include "app/options.h"
#include "app/render_report.h"
#include "app/small_size.h"
#include "app/study_progress.h"
#include "app/verify_text.h"
#include "verify/verify_run.h"

#include <chrono>
#include <fmt/format.h>

namespace abbe {

namespace {

constexpr int kVerifySide = 96; // pixels, of a picture whose size nobody asked for

class VerifyCommand {
  public:
    VerifyCommand(const VerifyOptions& options, const CommonOptions& common)
        : options_(options), common_(common),
          messages_(common.json ? makeJsonReport(common.console) : makeHumanReport(common.console, true)) {}

    ExitCode run() {
        if (const ExitCode code = load(); code != ExitCode::done) return code;
        InterruptGuard interrupt;
        const auto report = measure(interrupt);
        if (!report) {
            say("interrupted; nothing is known yet");
            return static_cast<ExitCode>(128 + interrupt.signal());
        }
        const bool warned = warnOf(*report);
        const VerifyFacts facts{options_.input.path, &built_.scene, subjectSize()};
        common_.console.data(common_.json ? verifyJson(*report, facts) + "\n" : verifyText(*report, facts));
        return !report->agreement.agrees() || (options_.strict && warned) ? ExitCode::threshold : ExitCode::done;
    }

  private:
    ExitCode load();
    std::optional<VerifyReport> measure(InterruptGuard&);
    Vec2i subjectSize() const {
        const FilmSettings film = filmSettings(built_.film);
        return {film.width, film.height};
    }
    bool warnOf(const VerifyReport&);
    void say(const std::string& line) const {
        if (!options_.quiet && !common_.json) common_.console.line(line);
    }
    void warn(Diagnostics& all, const char* code, std::string message, std::string help) const {
        all.warning(code, {}, std::move(message)).help = std::move(help);
    }

    const VerifyOptions& options_;
    const CommonOptions& common_;
    std::unique_ptr<RenderReport> messages_;
    std::unique_ptr<LoadedScene> loaded_;
    BuiltScene built_;
};

ExitCode VerifyCommand::load() {
    loaded_ = loadScene(options_.input);
    BuildOptions build = options_.build;
    if (!build.size && loaded_->readable && !loaded_->diagnostics.hasErrors())
        build.size = smallSize(*loaded_, build, kVerifySide);
    if (loaded_->readable) built_ = buildScene(loaded_->tree, loaded_->types, build, loaded_->diagnostics);
    messages_->diagnostics(loaded_->diagnostics, loaded_->sources);
    if (const ExitCode code = loaded_->exitCode(); code != ExitCode::done) return code;
    built_.film.crop.reset();
    built_.film.overscan.clear();
    Diagnostics faults;
    for (const FilmFault& fault : findFaults(built_.film))
        faults.error(std::string(fault.code), {}, fault.message).help = fault.help;
    if (!faults.hasErrors()) return ExitCode::done;
    messages_->diagnostics(faults, loaded_->sources);
    return ExitCode::usage;
}

std::optional<VerifyReport> VerifyCommand::measure(InterruptGuard& interrupt) {
    using Form = StudyProgressLine::Form;
    StudyProgressLine line(common_.console, common_.json ? Form::json : options_.quiet ? Form::none : Form::human);
    VerifyPlan plan;
    plan.resolution = options_.resolution;
    plan.timeLimit = options_.timeLimit;
    if (options_.samples) plan.samples = static_cast<std::uint32_t>(*options_.samples);
    plan.level = options_.level;
    plan.seed = renderSettings(built_.render).seed;
    const auto start = std::chrono::steady_clock::now();
    const VerifyControl control{&interrupt.stop(), [&](double fraction) {
                                    StudyProgress p;
                                    p.fraction = fraction;
                                    p.what = fraction > 0 ? "rendering" : "pilot";
                                    p.elapsed =
                                        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
                                    line.show(p);
                                }};
    return verify(built_, plan, control);
}

bool VerifyCommand::warnOf(const VerifyReport& r) {
    Diagnostics all;
    const Agreement& a = r.agreement;
    if (!a.whole.judged)
        warn(all, "W0735", "the picture is too noisy to say anything: single replicates make most of the variance",
             "give it more `--time`");
    else if (r.timeLimited && a.whole.error > options_.resolution)
        warn(all, "W0735",
             fmt::format("the difference is known to {} only, {} was wanted", verifyPercent(a.whole.error),
                         verifyPercent(options_.resolution)),
             "give it more `--time`");
    if (const std::uint64_t dropped = r.sides[0].dropped + r.sides[1].dropped)
        warn(all, "W0734",
             fmt::format("{} samples were dropped: something in them was not finite, or negative", dropped),
             "`abbe render` of the scene with its samples tells where");
    messages_->diagnostics(all, loaded_->sources);
    return a.whole.judged ? !all.all().empty() : true;
}

} // namespace

ExitCode run(const VerifyOptions& options, const CommonOptions& common) { return VerifyCommand(options, common).run(); }

} // namespace abbe
