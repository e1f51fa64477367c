#include "reports/light_path_text.h"

#include "reports/progress_text.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe {

namespace {

using enum LightPathVerdict;

// In a line; more are told where there is room.
constexpr std::size_t kInLine = 3;

constexpr std::string_view wordOf(LightPathVerdict v) {
    switch (v) {
    case used:
        return "used";
    case asked:
        return "asked";
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
        return "nobody looked for caustics: `--pilot 0`, or `--time` is too short for it";
    default:
        return "nobody looked";
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
        fmt::format("Glints, small images of lamps in mirrors and glass: a pilot took {} rays\n", f.pilotRays);
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
    return fmt::format("light paths {:.3g} per camera path{}: {}{}", f.share, f.verdict == asked ? ", as asked" : "",
                       forecast(f), sharesInLine(f));
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
    return fmt::format("{} small image{} of lamps in mirrors and glass {} probed: {:.2g} rays for each camera path",
                       f.found, f.found == 1 ? "" : "s", f.found == 1 ? "is" : "are", f.rays);
}

std::string lightPathText(const CausticFindings& all) {
    const auto& f = all.of<LightPathFindings>();
    if (f.verdict == undecided) return {};
    if (!f.measured) return fmt::format("Light paths: none, {}\n", reason(f));
    std::string text = f.used() ? fmt::format("Light paths: {:.3g} per camera path{}\n", f.share,
                                              f.verdict == asked ? ", as `light-paths` of `render` asks" : "")
                                : fmt::format("Light paths: none, {}\n", reason(f));
    if (f.used())
        text += fmt::format("  {:.3g} % of them go on past what first spreads them, a rough surface or a medium\n",
                            100 * f.afterSpread);
    text += fmt::format("  {} light{}, {} target{}; a pilot of size {} took {} rays\n", f.lights,
                        f.lights == 1 ? "" : "s", f.targets, f.targets == 1 ? "" : "s", all.pilot, f.rays);
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
