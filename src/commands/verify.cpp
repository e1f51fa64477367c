#include "app/program_end.h"
#include "base/stopwatch.h"
#include "command_line/arguments.h"
#include "command_line/shared_arguments.h"
#include "commands/command_table.h"
#include "commands/measured_scene.h"
#include "reports/findings.h"
#include "reports/progress.h"
#include "reports/render_report.h"
#include "verify/verify_run.h"

#include <charconv>
#include <fmt/format.h>

namespace abbe {

const char* const kVerifyHelp = R"(Renders a scene by two independent estimators and tests whether they agree.

Examples:
  abbe verify room.scene                     seconds to minutes; exit code 4 if they differ
  abbe verify room.scene --resolution 0.02   know the difference to 0.02 % of the picture
  abbe verify room.scene --size 320x180 --time 20min
  abbe verify room.scene --samples 1024 --seed 7 --json)";

namespace {

// "0.1" or "0.1%": per cent.
std::optional<double> readPercent(const std::string& text) {
    double percent = 0;
    const char* last = text.data() + text.size();
    const auto [end, fault] = std::from_chars(text.data(), last, percent);
    const std::string_view rest(end, static_cast<std::size_t>(last - end));
    if (fault != std::errc() || !(rest.empty() || rest == "%" || rest == " %") || !(percent > 0 && percent <= 100))
        return std::nullopt;
    return percent / 100;
}

} // namespace

void addArguments(Arguments& a, VerifyOptions& o) {
    constexpr const char* kPart = "a part in per cent such as 0.1";
    a.argument("scene", &o.input.path, "Scene file").require();
    a.value("--camera", "NAME", &o.build.camera, "Camera to render; without it the first one");
    addOwnSize(a, o.build.size, "Size of the pictures; without it that of the scene, at most 96 pixels a side");
    a.read("--resolution", "PERCENT", o.resolution, kPart, readPercent,
           "Standard error of the difference to render to; 0.1 when absent");
    a.read("--time", "TIME", o.timeLimit, "a time such as 20min", readTime,
           "Most time for it: 90, 20min, 2h; 5min when absent");
    a.value("--samples", "N", &o.samples, "Samples per pixel of either, in place of resolution and time")
        .between(32, 1 << 24);
    a.read("--level", "PERCENT", o.level, kPart, readPercent, "Probability of a false alarm; 0.1 when absent");
    addOwnSeed(a, o.build.seed);
    addThreads(a);
    a.flag("--strict", &o.strict, "Warnings end with exit code 4, too");
    addJson(a, "JSON lines on stdout");
    a.flag("--quiet,-q", &o.quiet, "Say nothing but the result");
    addDefines(a, o.input.defines);
    addLayers(a, o.input.layers);
    addMoment(a, o.input.frame);
}

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
