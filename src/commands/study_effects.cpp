#include "commands/study_effects.h"

#include "app/identity.h"
#include "app/program_end.h"
#include "base/parallel.h"
#include "io/file.h"
#include "io/png_writer.h"
#include "pages/pages.h"
#include "reports/image_header.h"
#include "reports/progress.h"
#include "reports/render_text.h"
#include "spectrum/color_space.h"

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>

namespace abbe {

namespace {

constexpr std::uint32_t kSamples = 64; // of each render, where nobody asked for others
constexpr const char* kEffectMeasure =
    "deltaTime: share of the processor time of rendering that goes with the effect, over pairs of one seed; flip: mean "
    "HDR-FLIP between the images; relMse = mean (x - a)(x' - b)/(r^2 + 0.01 mean(r)^2) of the image without the "
    "effect, "
    "x, x', a, b of two halves of the pairs, whose noise cancels; r = (a + b)/2.";

Json png(const RgbImage& image) {
    if (image.rgb.empty()) return {};
    std::vector<float> encoded;
    for (const float v : image.rgb) encoded.push_back(static_cast<float>(linearToSrgb(static_cast<double>(v))));
    const std::vector<char> bytes = encodePng({image.width(), image.height(), encoded});
    return base64({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()});
}

std::string placeOf(Span span, const SourceMap& sources) {
    if (!span.valid()) return {};
    const LineColumn at = sources.lineColumn(span.file, span.begin);
    return fmt::format("{}:{}:{}", std::filesystem::path(sources.path(span.file)).filename().string(), at.line,
                       at.column);
}

Json findingJson(const EffectFinding& f, const SourceMap& sources) {
    Json json = Json::object({{"name", f.name}, {"place", placeOf(f.place, sources)}});
    if (!f.reason.empty()) return json.set("reason", f.reason);
    std::string note;
    if (f.predicted) note = fmt::format("the cost report predicts {:.1f} %", 100 * *f.predicted);
    return json.set("secondsOn", f.secondsOn)
        .set("secondsOff", f.secondsOff)
        .set("deltaTime", f.deltaTime)
        .set("low", f.low)
        .set("high", f.high)
        .set("predicted", f.predicted ? Json(*f.predicted) : Json())
        .set("flip", f.flip)
        .set("relMse", f.relMse)
        .set("note", note)
        .set("reason", Json())
        .set("png", png(f.image));
}

} // namespace

std::string effectsJson(const EffectStudy& study, const StudyOptions& options, const CommonOptions& common,
                        const LoadedScene& loaded) {
    Json effects = Json::list();
    for (const EffectFinding& f : study.findings) effects.push(findingJson(f, loaded.sources));
    return Json::object({{"format", "abbe-study/1"},
                         {"program", Json::object({{"version", versionNumber()}, {"command", common.commandLine}})},
                         {"machine", Json::object({{"cpu", processorName()}, {"threads", threadCount()}})},
                         {"scene", Json::object({{"path", options.input.path},
                                                 {"name", std::filesystem::path(options.input.path).stem().string()},
                                                 {"width", study.image.width()},
                                                 {"height", study.image.height()},
                                                 {"effects", effectNames(study.effects)}})},
                         {"replicates", options.seeds},
                         {"seed", static_cast<std::int64_t>(options.build.seed.value_or(0))},
                         {"measure", kEffectMeasure},
                         {"curves", Json::list()},
                         {"effects", std::move(effects)},
                         {"cost", costJson(study.cost)},
                         {"referencePng", png(study.image)}})
               .text() +
           "\n";
}

std::string effectsCsv(const EffectStudy& study) {
    std::string text =
        fmt::format("# {}\neffect,seconds_on,seconds_off,delta_time,low,high,predicted,flip,relmse\n", kEffectMeasure);
    for (const EffectFinding& f : study.findings)
        if (f.reason.empty())
            text += fmt::format("{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{},{:.6g},{:.6g}\n", f.name, f.secondsOn,
                                f.secondsOff, f.deltaTime, f.low, f.high,
                                f.predicted ? fmt::format("{:.6g}", *f.predicted) : "", f.flip, f.relMse);
    return text;
}

std::string effectsTable(const EffectStudy& study) {
    if (study.findings.empty()) return "nothing in this scene can be left out\n";
    std::string text = fmt::format("{:<24}{:>26}{:>11}{:>9}{:>10}\n", "effect", "share of the time (95 %)", "predicted",
                                   "FLIP", "error");
    for (const EffectFinding& f : study.findings) {
        if (!f.reason.empty()) {
            text += fmt::format("{:<24}  {}\n", f.name, f.reason);
            continue;
        }
        const std::string share =
            fmt::format("{:.1f} % ({:.1f} to {:.1f})", 100 * f.deltaTime, 100 * f.low, 100 * f.high);
        const std::string predicted = f.predicted ? fmt::format("{:.1f} %", 100 * *f.predicted) : "-";
        const std::string error = f.relMse > 0 ? fmt::format("{:.2g} %", 100 * std::sqrt(f.relMse)) : "-";
        text += fmt::format("{:<24}{:>26}{:>11}{:>9.4f}{:>10}\n", f.name, share, predicted, f.flip, error);
    }
    return text;
}

ExitCode studyEffects(const StudyOptions& options, const CommonOptions& common, const LoadedScene& loaded,
                      const BuildOptions& build, const std::string& name) {
    using Form = StudyProgressLine::Form;
    InterruptGuard interrupt;
    StudyProgressLine line(common.console, common.json ? Form::json : options.quiet ? Form::none : Form::human);
    const auto start = std::chrono::steady_clock::now();
    EffectStudyInput input{&loaded.tree, &loaded.types, build};
    input.pairs = options.seeds;
    input.samples = options.samples ? static_cast<std::uint32_t>(*options.samples) : kSamples;
    input.stop = &interrupt.stop();
    input.progress = [&](const std::string& what, double done) {
        StudyProgress p;
        p.what = "without " + what;
        p.fraction = done;
        p.elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        if (done > 0.05) p.left = p.elapsed * (1 - done) / done;
        line.show(p);
    };
    const EffectStudy study = measureEffects(input);
    line.clear();
    if (study.stopped) return static_cast<ExitCode>(128 + interrupt.signal());
    const std::string json = effectsJson(study, options, common, loaded);
    writeAtomically(name + ".json", json);
    writeAtomically(name + ".csv", effectsCsv(study));
    writeAtomically(name + ".html", studyPage(json));
    if (common.json) {
        for (const char* extension : {".html", ".csv", ".json"})
            common.console.data(Json::object({{"event", "file"}, {"path", name + extension}}).text() + "\n");
        common.console.data(Json::object({{"event", "done"}, {"complete", true}}).text() + "\n");
    } else if (!options.quiet) {
        common.console.data(effectsTable(study));
        for (const char* extension : {".html", ".csv", ".json"}) common.console.line("study " + name + extension);
    }
    return ExitCode::done;
}

} // namespace abbe
