#include "app/study_files.h"

#include "app/json.h"
#include "app/machine.h"
#include "app/page_text.h"
#include "app/progress_text.h"
#include "app/version.h"
#include "study/error_colours.h"

#include <cmath>
#include <fmt/format.h>

namespace abbe {

namespace {

constexpr const char* kMeasure =
    "relMSE = mean (x - a)(x - b)/(r^2 + 0.01 mean(r)^2) over pixels and components of linear RGB; a, b: references of "
    "independent seeds, whose noise cancels; r = (a + b)/2. An error of 1 % is a relMSE of 1e-4.";

Json png(const std::vector<char>& bytes) {
    return base64({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()});
}

Json pointJson(const StudyCurve& curve, std::size_t k) {
    const CurveStatistics& s = curve.statistics;
    Json runs = Json::list();
    for (const SeedRun& run : s.runs())
        runs.push(Json::object({{"seed", run.seed},
                                {"relMse", run.rungs[k].relMse},
                                {"trimmed", run.rungs[k].trimmed},
                                {"seconds", run.rungs[k].seconds},
                                {"coreSeconds", run.rungs[k].coreSeconds}}));
    const Estimate error = s.error(k), &bias = curve.bias[k];
    return Json::object({{"samples", s.samples()[k]},
                         {"seconds", s.seconds(k)},
                         {"coreSeconds", s.coreSeconds(k)},
                         {"rays", s.rays(k)},
                         {"relMse", error.value},
                         {"low", error.low},
                         {"high", error.high},
                         {"trimmed", s.trimmed(k)},
                         {"bias2", bias.value},
                         {"bias2Low", bias.low},
                         {"bias2High", bias.high},
                         {"runs", runs}});
}

Json timesJson(const CurveStatistics& s, const std::vector<double>& errors, const Estimate& floor) {
    Json list = Json::list();
    for (const double error : errors) {
        const TimeToError t = s.timeTo(error, floor);
        list.push(Json::object({{"error", error},
                                {"seconds", t.seconds.value},
                                {"low", t.seconds.low},
                                {"high", t.seconds.high},
                                {"samples", t.samples},
                                {"extrapolated", t.extrapolated},
                                {"reachable", t.reachable}}));
    }
    return list;
}

Json curveJson(const StudyCurve& curve, const StudyCurve& main, const StudyFacts& facts) {
    const StudyVariant& v = curve.variant;
    const CurveStatistics& s = curve.statistics;
    Json points = Json::list();
    for (std::size_t k = 0; k < s.rungs(); ++k) points.push(pointJson(curve, k));
    const Estimate slope = s.slope(), cost = s.halfNoiseCost(), floor = curve.floor();
    const Estimate ratio = &curve == &main ? Estimate{1, 1, 1} : s.efficiencyAgainst(main.statistics);
    return Json::object({{"id", v.id},
                         {"label", v.label},
                         {"group", v.group},
                         {"change", v.change},
                         {"bias", name(v.bias)},
                         {"note", v.note},
                         {"points", points},
                         {"fit", Json::object({{"slope", slope.value},
                                               {"low", slope.low},
                                               {"high", slope.high},
                                               {"halfNoiseCost", cost.value},
                                               {"halfNoiseCostLow", cost.low},
                                               {"halfNoiseCostHigh", cost.high}})},
                         {"floor", Json::object({{"relMse", floor.value}, {"low", floor.low}, {"high", floor.high}})},
                         {"efficiency", Json::object({{"ratio", ratio.value},
                                                      {"low", ratio.low},
                                                      {"high", ratio.high},
                                                      {"seconds", s.commonSeconds(main.statistics)}})},
                         {"timeTo", timesJson(s, facts.errors, floor)}});
}

Json stripsJson(const StudyReport& report) {
    Json strips = Json::list();
    for (const StudyStrip& strip : report.strips) {
        Json images = Json::list();
        for (const StudyStrip::Picture& p : strip.pictures)
            images.push(Json::object({{"curve", p.curve},
                                      {"samples", p.samples},
                                      {"relMse", p.relMse},
                                      {"png", png(p.png)},
                                      {"error", png(p.errorPng)}}));
        strips.push(Json::object({{"seconds", strip.seconds}, {"images", images}}));
    }
    return strips;
}

Json scaleJson(double high) {
    constexpr int kStops = 16;
    Json stops = Json::list();
    for (int i = 0; i <= kStops; ++i) {
        Json stop = Json::list();
        for (const float v : ErrorColours::at(static_cast<double>(i) / kStops))
            stop.push(static_cast<int>(std::lround(255 * v)));
        stops.push(stop);
    }
    return Json::object(
        {{"name", ErrorColours::kName}, {"low", 0}, {"high", high}, {"unit", "relative error"}, {"stops", stops}});
}

} // namespace

std::string studyJson(const StudyReport& report, const StudyFacts& facts) {
    Json curves = Json::list(), leftOut = Json::list();
    for (const StudyCurve& curve : report.curves) curves.push(curveJson(curve, report.curves[0], facts));
    for (const LeftOutVariant& v : facts.leftOut)
        leftOut.push(Json::object({{"id", v.id}, {"label", v.label}, {"reason", v.reason}}));
    return Json::object({{"format", "abbe-study/1"},
                         {"program", Json::object({{"version", versionNumber()}, {"command", facts.command}})},
                         {"machine", Json::object({{"cpu", processorName()}, {"threads", facts.threads}})},
                         {"scene", Json::object({{"path", facts.scene},
                                                 {"name", facts.name},
                                                 {"width", facts.width},
                                                 {"height", facts.height},
                                                 {"effects", facts.effects}})},
                         {"replicates", facts.seeds},
                         {"complete", facts.complete},
                         {"seed", facts.seed},
                         {"measure", kMeasure},
                         {"reference", Json::object({{"samplesPerHalf", report.referenceSamples},
                                                     {"seconds", report.referenceSeconds},
                                                     {"relMse", report.referenceRelMse},
                                                     {"advantage", report.referenceAdvantage}})},
                         {"curves", curves},
                         {"leftOut", leftOut},
                         {"strips", stripsJson(report)},
                         {"errorScale", scaleJson(report.errorScale)},
                         {"exposure", report.exposure},
                         {"referencePng", png(report.referencePng)}})
               .text() +
           "\n";
}

std::string studyCsv(const StudyReport& report, const StudyFacts& facts) {
    std::string text = fmt::format("# abbe study {} of {}, {}x{} pixels, {} threads\n# {}\n# {}\n"
                                   "# reference: 2 x {} samples, relMSE {:.6g}\n"
                                   "# seconds and core_seconds are of the whole render up to that rung\n"
                                   "variant,samples,seed,relmse,relmse_trimmed,seconds,core_seconds,rays\n",
                                   versionNumber(), facts.scene, facts.width, facts.height, facts.threads,
                                   facts.command, kMeasure, report.referenceSamples, report.referenceRelMse);
    for (const StudyCurve& curve : report.curves)
        for (std::size_t k = 0; k < curve.statistics.rungs(); ++k)
            for (const SeedRun& run : curve.statistics.runs()) {
                const RungRun& r = run.rungs[k];
                // As many digits as the numbers have.
                text +=
                    fmt::format("{},{},{},{},{},{:.6g},{:.6g},{}\n", curve.variant.id, curve.statistics.samples()[k],
                                run.seed, r.relMse, r.trimmed, r.seconds, r.coreSeconds, r.rays);
            }
    return text;
}

std::string studyTable(const StudyReport& report, const StudyFacts& facts) {
    const auto range = [](const Estimate& e, const char* form) {
        if (!e.known()) return std::string("-");
        std::string text = fmt::format(fmt::runtime(form), e.value);
        if (e.bounded())
            text += fmt::format(" [{}, {}]", fmt::format(fmt::runtime(form), e.low),
                                fmt::format(fmt::runtime(form), e.high));
        return text;
    };
    std::string text =
        fmt::format("{:<22} {:>8} {:>9} {:>8}  {:<22} {:<24} {}\n", "", "samples", "seconds", "error",
                    "slope of relMSE", "efficiency", fmt::format("time to {:g} %", 100 * facts.errors[0]));
    for (const StudyCurve& curve : report.curves) {
        const CurveStatistics& s = curve.statistics;
        const std::size_t last = s.rungs() - 1;
        const double error = s.error(last).value;
        const TimeToError time = s.timeTo(facts.errors[0], curve.floor());
        const std::string seconds = !time.reachable         ? "never"
                                    : !time.seconds.known() ? "-"
                                                            : fmt::format("{:.3g} s", time.seconds.value);
        text += fmt::format(
            "{:<22} {:>8} {:>9.3g} {:>8}  {:<22} {:<24} {}{}\n", curve.variant.label, s.samples()[last],
            s.seconds(last), error > 0 ? fmt::format("{:.3g} %", 100 * std::sqrt(error)) : "-",
            range(s.slope(), "{:.2f}"),
            &curve == &report.curves[0] ? "1" : range(s.efficiencyAgainst(report.curves[0].statistics), "{:.3g}"),
            seconds, time.extrapolated && time.seconds.known() ? " (extrapolated)" : "");
    }
    return text;
}

} // namespace abbe
