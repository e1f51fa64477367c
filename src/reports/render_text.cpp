#include "reports/render_text.h"

#include "app/console.h"
#include "reports/progress.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace abbe {

namespace {

bool hasScreen() {
    for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY"})
        if (const char* value = std::getenv(name); value && *value) return true;
    return false;
}

} // namespace

std::string pictureLine(const PictureFigures& f) {
    std::string text = fmt::format("picture median {:.3g} nits, 99 % of it up to {:.3g} nits", f.median, f.high);
    if (f.display)
        text += fmt::format("   display {:.1f} % below 1 %, {:.1f} % above 99 %", 100 * f.display->black,
                            100 * f.display->white);
    return text;
}

std::string viewingLine(const std::string& png) {
    if (hasScreen()) return fmt::format("to look at it:  xdg-open {}", shellQuoted(png));
    std::error_code error;
    const auto path = std::filesystem::absolute(png, error);
    return fmt::format("to look at it:  copy {} to a machine with a screen",
                       shellQuoted(error ? png : path.lexically_normal().string()));
}

Json pictureJson(const PictureFigures& f, const Exposure& exposure) {
    return Json::object({{"median_nits", f.median},
                         {"nits_99", f.high},
                         {"display_black", f.display ? Json(f.display->black) : Json()},
                         {"display_white", f.display ? Json(f.display->white) : Json()},
                         {"missing_stops", f.missingStops ? Json(*f.missingStops) : Json()},
                         {"exposure_stops", exposure.stops},
                         {"exposure_auto", exposure.automatic}});
}

namespace {

Json rowJson(const CostRow& row, double seconds) {
    Json json = Json::object({{"id", row.id},
                              {"label", row.label},
                              {"seconds", row.seconds},
                              {"uncertainty", row.uncertainty},
                              {"share", seconds > 0 ? row.seconds / seconds : 0},
                              {"elsewhere", row.elsewhere},
                              {"rays", row.rays}});
    if (!row.counted.empty()) json.set("count", row.count).set("counted", row.counted);
    if (row.first > 0) json.set("first", row.first);
    if (!row.note.empty()) json.set("note", row.note);
    return json;
}

bool shown(const CostRow& row) { return row.seconds > 0 || row.elsewhere > 0 || row.rays > 0 || row.count > 0; }

std::string countOf(std::uint64_t n) {
    std::string text = countText(static_cast<double>(n));
    while (!text.empty() && text.back() == ' ') text.pop_back();
    return text;
}

std::string line(const CostRow& row, double seconds) {
    std::string text = fmt::format("  {} {:>9.3f} s ±{:<7.3f}{:>6.1f} %", padded(row.label, 26), row.seconds,
                                   row.uncertainty, seconds > 0 ? 100 * row.seconds / seconds : 0);
    text += row.rays > 0 ? fmt::format("  {:>9} rays", countOf(row.rays)) : std::string(16, ' ');
    if (row.count > 0) text += fmt::format("  {} {}", countOf(row.count), row.counted);
    if (row.elsewhere > 0) text += fmt::format("  and {:.3f} s in other rows", row.elsewhere);
    while (text.back() == ' ') text.pop_back();
    return text + "\n";
}

CostRow readRow(const nlohmann::ordered_json& json) {
    CostRow row;
    row.id = json.at("id").get<std::string>();
    row.label = json.at("label").get<std::string>();
    row.seconds = json.at("seconds").get<double>();
    row.uncertainty = json.value("uncertainty", 0.0);
    row.elsewhere = json.value("elsewhere", 0.0);
    row.rays = json.value("rays", std::uint64_t{0});
    row.count = json.value("count", std::uint64_t{0});
    row.counted = json.value("counted", std::string());
    row.note = json.value("note", std::string());
    row.first = json.value("first", std::uint64_t{0});
    return row;
}

} // namespace

Json costJson(const CostReport& cost) {
    Json rows = Json::list();
    for (const CostRow& row : cost.rows) rows.push(rowJson(row, cost.seconds));
    return Json::object({{"seconds", cost.seconds},
                         {"accounted", cost.accounted},
                         {"rendering", cost.rendering},
                         {"threads", cost.threads},
                         {"looks", cost.looks},
                         {"paths", cost.paths},
                         {"untouched", cost.untouched},
                         {"rows", std::move(rows)}});
}

std::string costTable(const CostReport& cost) {
    std::string text = fmt::format("cost: {:.2f} s on {} thread{}, of which the rows have {:.1f} %\n", cost.seconds,
                                   cost.threads, cost.threads == 1 ? "" : "s", 100 * cost.accounted);
    for (const CostRow& row : cost.rows)
        if (shown(row)) text += line(row, cost.seconds);
    for (const CostRow& row : cost.rows)
        if (shown(row) && !row.note.empty()) text += fmt::format("  {}: {}\n", row.label, row.note);
    return text;
}

ImageAttribute costAttribute(const CostReport& cost) { return {"abbe.cost", costJson(cost).text()}; }

// Under either name: images of before November 2026 have the second.
bool isCostAttribute(const ImageAttribute& a) { return a.name == "abbe.cost" || a.name == "abbe.bill"; }

std::optional<CostReport> readCost(std::span<const ImageAttribute> attributes) {
    const auto found = std::ranges::find_if(attributes, isCostAttribute);
    const auto* text = found == attributes.end() ? nullptr : std::get_if<std::string>(&found->value);
    if (!text) return std::nullopt;
    try {
        const auto json = nlohmann::ordered_json::parse(*text);
        CostReport cost;
        cost.seconds = json.at("seconds").get<double>();
        cost.accounted = json.value("accounted", 0.0);
        cost.rendering = json.value("rendering", 0.0);
        cost.threads = json.value("threads", 0);
        cost.looks = json.value("looks", std::uint64_t{0});
        cost.paths = json.value("paths", std::uint64_t{0});
        cost.untouched = json.value("untouched", std::uint64_t{0});
        for (const auto& row : json.at("rows")) cost.rows.push_back(readRow(row));
        return cost;
    } catch (const nlohmann::ordered_json::exception&) { // of another program, or of a later one
        return std::nullopt;
    }
}

namespace {

using enum LightPathVerdict;

// In a line; more are listed where there is room.
constexpr std::size_t kInLine = 3;

constexpr std::string_view wordOf(LightPathVerdict v) {
    switch (v) {
    case used:
        return "used";
    case requested:
        return "requested";
    case off:
        return "off";
    case otherTechnique:
        return "other-technique";
    case hiddenShapes:
        return "hidden-shapes";
    case noLights:
        return "no-lights";
    case nothingFocuses:
        return "nothing-focuses";
    case nothingFound:
        return "nothing-found";
    case noGain:
        return "no-gain";
    case noPilot:
        return "no-pilot";
    case undecided:
        break;
    }
    return "undecided";
}

// Where camera paths cannot find what light paths bring there is no bound.
std::string times(double gain) {
    if (gain > 1e6) return "over a million ×";
    if (gain < 10) return fmt::format("{:.2g} ×", gain);
    const double digit = std::pow(10, std::floor(std::log10(gain)) - 1);
    return fmt::format("{:.0f} ×", std::round(gain / digit) * digit); // two digits
}

std::string forecast(const LightPathFindings& f) { return fmt::format("forecast {} as efficient", times(f.gain)); }

std::string pairName(const LightPathShare& s) {
    if (s.light.empty()) return "all others";
    return fmt::format("{} → {}", s.light, s.target.empty() ? "elsewhere" : s.target);
}

std::string sharesInLine(const LightPathFindings& f) {
    std::string text;
    for (std::size_t i = 0; i < std::min(kInLine, f.shares.size()); ++i)
        text += fmt::format("{}{} {:.0f} %", i > 0 ? ", " : "", pairName(f.shares[i]), 100 * f.shares[i].share);
    return text.empty() ? text : fmt::format(" ({}{})", text, f.shares.size() > kInLine ? ", …" : "");
}

std::string reason(const LightPathFindings& f) {
    switch (f.verdict) {
    case off:
        return "`light-paths off`";
    case otherTechnique:
        return "`sampler`, `strategy`, `mis-weights`, `directions` and `wavelengths` must be their defaults";
    case hiddenShapes:
        return "shadows and reflections see different shapes (`visible-to`)";
    case noLights:
        return "no light can start them";
    case nothingFocuses:
        return "nothing focuses light";
    case nothingFound:
        return fmt::format("what they could bring has hardly any noise, relative variance {:.2g} of a sample",
                           f.before);
    case noGain:
        return fmt::format("{}, with {:.3g} per camera path", forecast(f), f.bestShare);
    case noPilot:
        return "no pilot looked for caustics: `--pilot 0`, or `--time` is too short for it";
    default:
        return "no pilot has run";
    }
}

std::string moment(double v) { return v > 1e6 ? "unbounded" : fmt::format("{:.3g}", v); }

// A line for each light and target.
std::string shareTable(const LightPathFindings& f) {
    constexpr std::size_t kName = 44;
    const bool judged = f.bestShare > 0;
    std::string text = fmt::format("  {} {:>10} {:>14}{}\n", padded("from → to, and second moment found", kName),
                                   "of them", "camera alone", judged ? fmt::format(" {:>10}", "with both") : "");
    for (const LightPathShare& s : f.shares)
        text += fmt::format("  {} {:>8.1f} % {:>14}{}\n", padded(pairName(s), kName), 100 * s.share, moment(s.before),
                            judged ? fmt::format(" {:>10}", moment(s.after)) : "");
    return text;
}

std::string manifoldName(const ManifoldFindings& f) {
    return f.estimates > 1 ? fmt::format("manifold sampling ({} estimates a vertex)", f.estimates)
                           : "manifold sampling";
}

// Empty where nothing was looked for.
std::string manifoldText(const ManifoldFindings& f) {
    std::string text;
    if (f.measured)
        text = fmt::format("Caustics behind glass and in mirrors: {}, forecast {} as efficient\n",
                           f.used            ? manifoldName(f)
                           : f.leftToMerging ? fmt::format("left to merging, as a pilot found too few ({})", f.chains)
                                             : "left to camera paths",
                           times(f.gain));
    for (const std::string& obstacle : f.obstacles) text += fmt::format("  not followed: {}\n", obstacle);
    if (f.obstacleCount > f.obstacles.size())
        text += fmt::format("  and {} more\n", f.obstacleCount - f.obstacles.size());
    return text;
}

std::string listed(const std::vector<std::string>& names) {
    std::string text;
    for (std::size_t i = 0; i < std::min(kInLine, names.size()); ++i) text += (i > 0 ? ", " : "") + names[i];
    return names.size() > kInLine ? text + ", …" : text;
}

// Empty where nobody looked.
std::string mergeText(const MergeFindings& f) {
    if (!f.measured) return {};
    std::string text = "Caustics behind glass and in mirrors that are left: ";
    if (!f.found) return text + "none that light paths come to\n";
    if (f.used)
        text +=
            fmt::format("merged, of {}, a round of {} light paths for {} of each replicate; consistent, not "
                        "unbiased\n",
                        listed(f.lights), f.photons, f.every == 1 ? "each sample" : fmt::format("{} samples", f.every));
    else
        text += "left to camera paths\n";
    if (!f.unseen.empty()) text += fmt::format("  camera paths never find that of {}\n", listed(f.unseen));
    if (f.lights.empty()) return text + "  camera paths find it better than merging does\n";
    return text +
           fmt::format("  forecast {} as efficient; relative second moment of a sample {} by camera paths, {} by "
                       "merging\n",
                       times(f.gain), moment(f.before), moment(f.after));
}

std::string glintText(const GlintFindings& f) {
    if (!f.measured) return {};
    std::string text =
        fmt::format("Glints, small images of lights in mirrors and glass: a pilot took {} rays\n", f.pilotRays);
    if (f.found == 0) return text + "  none that camera paths would not find soon enough\n";
    return text +
           fmt::format("  {} probed, {:.2g} rays for each camera path; without probes 1024 samples leave an error of "
                       "{:.2g} % in a tile of 8×8\n",
                       f.found, f.rays, 100 * f.error);
}

} // namespace

std::string lightPathLine(const LightPathFindings& f) {
    if (f.verdict == undecided) return {};
    if (!f.used()) return "no light paths: " + reason(f);
    return fmt::format("light paths {:.3g} per camera path{}: {}{}", f.share,
                       f.verdict == requested ? ", as requested" : "", forecast(f), sharesInLine(f));
}

std::string manifoldLine(const CausticFindings& all) {
    const auto& f = all.of<ManifoldFindings>();
    std::string text;
    if (f.used)
        text = fmt::format("{} behind glass and in mirrors: forecast {} as efficient", manifoldName(f), times(f.gain));
    if (f.used && f.obstacleCount > 0)
        text += fmt::format("; {} polished shape{} cannot be followed: what {} focus{} is {} there", f.obstacleCount,
                            f.obstacleCount == 1 ? "" : "s", f.obstacleCount == 1 ? "it" : "they",
                            f.obstacleCount == 1 ? "es" : "",
                            all.of<MergeFindings>().used ? "merged or found by chance" : "found by chance");
    return text;
}

std::string mergeLine(const MergeFindings& f) {
    if (!f.used) return {};
    return fmt::format("merging behind glass and in mirrors (biased, `merging off` leaves it out): forecast {} as "
                       "efficient, light of {}",
                       times(f.gain), listed(f.lights));
}

std::string glintLine(const GlintFindings& f) {
    if (f.found == 0) return {};
    return fmt::format("{} small image{} of lights in mirrors and glass {} probed: {:.2g} rays for each camera path",
                       f.found, f.found == 1 ? "" : "s", f.found == 1 ? "is" : "are", f.rays);
}

std::string guideLine(const GuideFindings& f) {
    if (f.verdict != GuideFindings::Verdict::used) return {};
    return fmt::format("paths guided to where pilots found light: in {} of {} regions{} ({:.2g} MB)", f.guided,
                       f.regions, f.distances ? " and by distances in media" : "", static_cast<double>(f.bytes) / 1e6);
}

Json guideJson(const GuideFindings& f) {
    constexpr std::array kWords = {"undecided", "off", "other-technique", "media", "no-pilot", "no-gain", "used"};
    return Json::object({{"verdict", std::string(kWords[static_cast<std::size_t>(f.verdict)])},
                         {"variance_taken", f.gain},
                         {"regions", static_cast<std::uint64_t>(f.regions)},
                         {"guided", static_cast<std::uint64_t>(f.guided)},
                         {"distances", f.distances},
                         {"bytes", static_cast<std::uint64_t>(f.bytes)}});
}

void addLook(Json& event, const LookFindings& found) {
    if (found.lightsByArrival) event.set("lights_by_arrival", true);
    if (found.walks.empty()) return;
    Json walks = Json::object({});
    for (const auto& [medium, share] : found.walks)
        walks.set(medium, std::round(100 * static_cast<double>(share)) / 100);
    event.set("walks_to_surface", std::move(walks));
}

std::string lightPathText(const CausticFindings& all) {
    const auto& f = all.of<LightPathFindings>();
    if (f.verdict == undecided) return {};
    if (!f.measured) return fmt::format("Light paths: none, {}\n", reason(f));
    std::string text = f.used() ? fmt::format("Light paths: {:.3g} per camera path{}\n", f.share,
                                              f.verdict == requested ? ", as `light-paths` of `render` asks" : "")
                                : fmt::format("Light paths: none, {}\n", reason(f));
    if (f.used())
        text += fmt::format("  {:.3g} % of them go on past what first spreads them, a rough surface or a medium\n",
                            100 * f.afterSpread);
    text +=
        fmt::format("  {} light{}, {} target{}; a pilot of size {} took {} rays\n", f.lights, f.lights == 1 ? "" : "s",
                    f.targets, f.targets == 1 ? "" : "s", all.pilot % RenderSettings::kGuidePilot, f.rays);
    if (f.bestShare > 0)
        text += fmt::format("  {} as camera paths alone with {:.3g} light paths for each of them\n", forecast(f),
                            f.bestShare);
    text += fmt::format("  relative variance of a sample by what light paths can bring: {} by camera paths alone",
                        moment(f.before));
    if (f.bestShare > 0) text += fmt::format(", {} by both; by everything else {}", moment(f.after), moment(f.rest));
    return text + "\n" + shareTable(f) + manifoldText(all.of<ManifoldFindings>()) + mergeText(all.of<MergeFindings>()) +
           glintText(all.of<GlintFindings>());
}

Json lightPathJson(const CausticFindings& all) {
    const auto& f = all.of<LightPathFindings>();
    Json json = Json::object({{"verdict", std::string(wordOf(f.verdict))}, {"text", lightPathLine(f)}});
    json.set("pilot", all.pilot);
    if (!f.measured) return json;
    json.set("per_camera_path", f.share).set("go_on_after_spread", f.afterSpread);
    json.set("judged_per_camera_path", f.bestShare).set("gain", f.gain);
    json.set("before", f.before).set("after", f.after).set("rest", f.rest);
    json.set("pilot_rays", f.rays).set("lights", f.lights).set("targets", f.targets);
    Json shares = Json::list();
    for (const LightPathShare& s : f.shares)
        shares.push(Json::object({{"light", s.light.empty() ? Json() : Json(s.light)},
                                  {"target", s.target.empty() ? Json() : Json(s.target)},
                                  {"share", s.share},
                                  {"before", s.before},
                                  {"after", s.after}}));
    const auto& m = all.of<ManifoldFindings>();
    Json obstacles = Json::list();
    for (const std::string& obstacle : m.obstacles) obstacles.push(Json(obstacle));
    json.set("manifold", Json::object({{"measured", m.measured},
                                       {"used", m.used},
                                       {"left_to_merging", m.leftToMerging},
                                       {"chains_found", m.chains},
                                       {"gain", m.gain},
                                       {"before", m.before},
                                       {"after", m.after},
                                       {"rest", m.rest},
                                       {"estimates", m.estimates},
                                       {"pilot_rays", m.rays},
                                       {"not_followed", std::move(obstacles)}}));
    const auto& g = all.of<MergeFindings>();
    Json lights = Json::list(), unseen = Json::list();
    for (const std::string& light : g.lights) lights.push(Json(light));
    for (const std::string& light : g.unseen) unseen.push(Json(light));
    json.set("merging", Json::object({{"measured", g.measured},
                                      {"used", g.used},
                                      {"found", g.found},
                                      {"gain", std::isfinite(g.gain) ? Json(g.gain) : Json()},
                                      {"before", std::isfinite(g.before) ? Json(g.before) : Json()},
                                      {"after", g.after},
                                      {"rest", g.rest},
                                      {"samples_per_round", static_cast<std::uint64_t>(g.every)},
                                      {"photons", static_cast<std::uint64_t>(g.photons)},
                                      {"more_camera_paths", static_cast<std::uint64_t>(g.more)},
                                      {"pilot_rays", g.rays},
                                      {"lights", std::move(lights)},
                                      {"never_found", std::move(unseen)}}));
    const auto& glints = all.of<GlintFindings>();
    json.set("glints", Json::object({{"measured", glints.measured},
                                     {"probed", static_cast<std::uint64_t>(glints.found)},
                                     {"error_without", glints.error},
                                     {"rays_per_camera_path", glints.rays},
                                     {"pilot_rays", glints.pilotRays}}));
    return json.set("shares", std::move(shares));
}

} // namespace abbe
