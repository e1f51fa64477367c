#include "reports/findings.h"

#include "app/identity.h"
#include "app/json.h"
#include "pages/pages.h"
#include "reports/progress.h"
#include "study/study_report.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <vector>

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

Json timeJson(const std::optional<TimeModel>& time) {
    return time ? Json::object({{"fixed", time->fixed}, {"perSample", time->perSample}}) : Json();
}

// `high` is null beside a number in `low` where there is no upper bound.
Json efficiencyJson(const StudyCurve& curve, const StudyCurve& main, TimeBasis basis) {
    const Estimate ratio =
        &curve == &main ? Estimate{1, 1, 1} : curve.statistics.efficiencyAgainst(main.statistics, basis);
    return Json::object({{"ratio", ratio.value},
                         {"low", ratio.low},
                         {"high", ratio.high},
                         {"seconds", curve.statistics.commonSeconds(main.statistics, basis)}});
}

Json curveJson(const StudyCurve& curve, const StudyCurve& main, const StudyFacts& facts) {
    const StudyVariant& v = curve.variant;
    const CurveStatistics& s = curve.statistics;
    Json points = Json::list();
    for (std::size_t k = 0; k < s.rungs(); ++k) points.push(pointJson(curve, k));
    const Estimate slope = s.slope(), cost = s.halfNoiseCost(), floor = curve.floor();
    return Json::object({{"id", v.id},
                         {"label", v.label},
                         {"group", v.group},
                         {"change", v.change},
                         {"bias", name(v.bias)},
                         {"note", curve.note.empty() ? std::string(v.note) : curve.note},
                         {"points", points},
                         {"fit", Json::object({{"slope", slope.value},
                                               {"low", slope.low},
                                               {"high", slope.high},
                                               {"halfNoiseCost", cost.value},
                                               {"halfNoiseCostLow", cost.low},
                                               {"halfNoiseCostHigh", cost.high}})},
                         {"floor", Json::object({{"relMse", floor.value}, {"low", floor.low}, {"high", floor.high}})},
                         {"time", timeJson(s.time())},
                         {"efficiency", efficiencyJson(curve, main, TimeBasis::sampling)},
                         {"efficiencyOfWhole", efficiencyJson(curve, main, TimeBasis::whole)},
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

Json peersJson(const StudyReport& report) {
    Json peers = Json::list();
    for (const StudyPeer& p : report.peers)
        peers.push(Json::object({{"id", p.id},
                                 {"name", p.name},
                                 {"version", p.version},
                                 {"variant", p.variant},
                                 {"reference", Json::object({{"samplesPerHalf", p.referenceSamples},
                                                             {"seconds", p.referenceSeconds},
                                                             {"relMse", p.referenceRelMse},
                                                             {"advantage", p.referenceAdvantage}})}}));
    return peers;
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
                         {"peers", peersJson(report)},
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
    for (const StudyPeer& p : report.peers)
        text.insert(text.find("variant,samples"),
                    fmt::format("# {}: {} {}, {}; reference of its own: 2 x {} samples, relMSE {:.6g}\n", p.id, p.name,
                                p.version, p.variant, p.referenceSamples, p.referenceRelMse));
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

namespace {

std::string rangeText(const Estimate& e, const char* form) {
    if (!e.known()) return "-";
    const auto number = [form](double v) {
        return std::isinf(v) ? std::string("no upper bound") : fmt::format(fmt::runtime(form), v);
    };
    if (!e.bounded()) return number(e.value) + " [no interval]";
    return fmt::format("{} [{}, {}]", number(e.value), number(e.low), number(e.high));
}

// Fixed: seconds of pilots and plans, which the slope and the efficiency leave out.
std::string rowText(const StudyCurve& curve, const StudyCurve& main, double wanted) {
    const CurveStatistics& s = curve.statistics;
    const std::size_t last = s.rungs() - 1;
    const double error = s.error(last).value;
    const TimeToError time = s.timeTo(wanted, curve.floor());
    const std::string seconds = !time.reachable         ? "never"
                                : !time.seconds.known() ? "-"
                                                        : fmt::format("{:.3g} s", time.seconds.value);
    return fmt::format(
        "{:<22} {:>8} {:>9.3g} {:>7} {:>8}  {:<22} {:<28} {}{}\n", curve.variant.label, s.samples()[last],
        s.seconds(last), s.time() ? fmt::format("{:.2g}", s.time()->fixed) : "-",
        error > 0 ? fmt::format("{:.3g} %", 100 * std::sqrt(error)) : "-", rangeText(s.slope(), "{:.2f}"),
        &curve == &main ? "1" : rangeText(s.efficiencyAgainst(main.statistics, TimeBasis::sampling), "{:.3g}"), seconds,
        time.extrapolated && time.seconds.known() ? " (extrapolated)" : "");
}

} // namespace

std::string studyTable(const StudyReport& report, const StudyFacts& facts) {
    const double wanted = facts.errors[0];
    std::string text =
        fmt::format("{:<22} {:>8} {:>9} {:>7} {:>8}  {:<22} {:<28} {}\n", "", "samples", "seconds", "fixed", "error",
                    "slope of relMSE", "efficiency of samples", fmt::format("time to {:g} %", 100 * wanted));
    for (const StudyCurve& curve : report.curves) text += rowText(curve, report.curves[0], wanted);
    return text + "fixed: seconds of pilots and plans, which more samples do not need; the efficiency is of the rest\n";
}

namespace {

constexpr std::size_t kShownBlocks = 5;
constexpr const char* kChannelNames[] = {"X", "Y", "Z"};

std::string signedPercent(double part) { return fmt::format("{:+.2g} %", 100 * part); }

const char* verdictOf(const Agreement& a) {
    if (!a.agrees()) return "differ";
    return a.whole.judged ? "agree" : "undecided";
}

// What is to be seen in a block, the commonest first: 4×4 rays tell.
std::vector<std::string> sights(const Scene& scene, const PixelBounds& b) {
    const auto nameOf = [&scene](const void* thing) {
        const auto found = scene.names.find(thing);
        return found == scene.names.end() ? std::string("?") : found->second;
    };
    std::map<std::string, int> counts;
    for (int i = 0; i < 16; ++i) {
        const float fx = (static_cast<float>(i % 4) + 0.5f) / 4, fy = (static_cast<float>(i / 4) + 0.5f) / 4;
        CameraSample at;
        at.film = {static_cast<float>(b.x0) + fx * static_cast<float>(b.width()),
                   static_cast<float>(b.y0) + fy * static_cast<float>(b.height())};
        at.lens = {0.5f, 0.5f};
        const CameraRay ray = scene.camera->ray(at);
        SurfaceHit hit;
        if (ray.weight > 0 && scene.intersector->intersect(ray.ray, hit))
            ++counts[fmt::format("object `{}`, material `{}`", nameOf(hit.shape), nameOf(hit.material))];
    }
    std::vector<std::pair<int, std::string>> order;
    for (const auto& [text, count] : counts) order.emplace_back(-count, text);
    std::sort(order.begin(), order.end());
    std::vector<std::string> names;
    for (std::size_t i = 0; i < std::min<std::size_t>(2, order.size()); ++i) names.push_back(order[i].second);
    return names;
}

} // namespace

std::string verifyPercent(double part) { return fmt::format("{:.2g} %", 100 * part); }

std::string verifyText(const VerifyReport& r, const VerifyFacts& facts) {
    const Agreement& a = r.agreement;
    std::string text = fmt::format("{}  {}×{}  {:.0f} s\n", facts.path, facts.size.x, facts.size.y, r.seconds);
    for (const VerifyReport::Side& s : r.sides)
        text += fmt::format("  {:<11} {:>7} samples  error {:<8}  {}\n", s.estimator.name, s.samples,
                            verifyPercent(s.error), s.estimator.how);
    if (a.whole.judged)
        text += fmt::format("  whole picture: {} ± {} in {}; of {} tiles {} are too noisy to be judged\n",
                            signedPercent(a.whole.difference), verifyPercent(a.whole.error),
                            kChannelNames[a.whole.channel], a.tiles, a.unjudged);
    for (const BlockTest& b : a.worstBlocks(kShownBlocks)) {
        text +=
            fmt::format("  pixels {},{} to {},{}: {} ± {} in {}\n", b.bounds.x0, b.bounds.y0, b.bounds.x1 - 1,
                        b.bounds.y1 - 1, signedPercent(b.difference), verifyPercent(b.error), kChannelNames[b.channel]);
        for (const std::string& sight : sights(*facts.scene, b.bounds)) text += fmt::format("    {}\n", sight);
    }
    const std::string v = verdictOf(a);
    if (v == "agree")
        text +=
            fmt::format("the estimators agree (p = {:.2g}); a difference of {} of the picture would have been seen\n",
                        a.probability, verifyPercent(a.detectable()));
    else if (v == "differ")
        text += fmt::format("the estimators DIFFER (p = {:.2g}): one of them is wrong, or both are\n", a.probability);
    else
        text += "undecided\n";
    return text;
}

std::string verifyJson(const VerifyReport& r, const VerifyFacts& facts) {
    const auto block = [&facts](const BlockTest& b) {
        Json names = Json::list();
        for (const std::string& s : sights(*facts.scene, b.bounds)) names.push(s);
        return Json::object({{"x0", b.bounds.x0},
                             {"y0", b.bounds.y0},
                             {"x1", b.bounds.x1},
                             {"y1", b.bounds.y1},
                             {"channel", kChannelNames[b.channel]},
                             {"difference", b.difference},
                             {"error", b.error},
                             {"score", b.score},
                             {"sights", std::move(names)}});
    };
    const Agreement& a = r.agreement;
    Json blocks = Json::list(), sides = Json::list();
    for (const BlockTest& b : a.worstBlocks(kShownBlocks)) blocks.push(block(b));
    for (const auto& s : r.sides)
        sides.push(Json::object({{"name", s.estimator.name},
                                 {"samples", s.samples},
                                 {"rays", s.rays},
                                 {"dropped", s.dropped},
                                 {"error", s.error}}));
    return Json::object({{"event", "verify"},
                         {"scene", facts.path},
                         {"verdict", verdictOf(a)},
                         {"probability", a.probability},
                         {"level", a.level},
                         {"difference", a.whole.difference},
                         {"error", a.whole.error},
                         {"channel", kChannelNames[a.whole.channel]},
                         {"detectable", a.whole.judged ? Json(a.detectable()) : Json()},
                         {"tiles", a.tiles},
                         {"unjudged", a.unjudged},
                         {"seconds", r.seconds},
                         {"estimators", std::move(sides)},
                         {"blocks", std::move(blocks)}})
        .text();
}

} // namespace abbe
