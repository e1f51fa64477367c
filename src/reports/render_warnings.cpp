#include "reports/render_warnings.h"

#include "app/console.h"
#include "film/error_figure.h"
#include "reports/progress.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace abbe {

namespace {

// Share of the densities above their bounds from which on it shows.
constexpr double kNotableExcess = 0.01;

} // namespace

void warnOfDroppedSamples(const RenderStatistics& statistics, std::span<const FoundFault> faults,
                          const std::string& command, Diagnostics& diagnostics) {
    const auto& [nan, infinite, negative] = statistics.dropped;
    if (nan + infinite + negative > 0) {
        Diagnostic& d =
            diagnostics.warning("W0640", faults.empty() ? Span{} : faults[0].declared,
                                fmt::format("{} of {} samples were dropped: {} not a number, {} infinite, {} negative",
                                            nan + infinite + negative, statistics.paths, nan, infinite, negative));
        for (const FoundFault& f : faults)
            d.notes.push_back(
                fmt::format("pixel {} sample {}: {}", pixelText(f.sample), sampleText(f.sample), text(f)));
        for (std::size_t i = faults.size(); i < statistics.examples.size(); ++i)
            d.notes.push_back(fmt::format("pixel {} sample {}", pixelText(statistics.examples[i]),
                                          sampleText(statistics.examples[i])));
        if (!statistics.examples.empty())
            d.help = fmt::format("`{} --pixel {} --sample {}` repeats the first one vertex by vertex", command,
                                 pixelText(statistics.examples[0]), sampleText(statistics.examples[0]));
    }
}

void warnOfDensities(const DensityExcess& excess, Diagnostics& diagnostics) {
    const double share =
        static_cast<double>(excess.above) / static_cast<double>(std::max<std::uint64_t>(1, excess.lookups));
    if (share < kNotableExcess) return;
    diagnostics.warning("W0643", {},
                        fmt::format("{} of {} densities of media were above their bound, at most {:.3g} times; the "
                                    "image is right but noisy there",
                                    excess.above, excess.lookups, excess.most));
}

void warnOfMissingSamples(const MissingSamples& missing, Diagnostics& diagnostics) {
    if (missing.pixels == 0) return;
    const std::string_view why = missing.allBegun ? "all samples of some pixels were dropped"
                                 : missing.dropped > 0
                                     ? "the time ended before every pixel had a sample, and samples were dropped"
                                     : "the time ended before every pixel had a sample";
    diagnostics
        .warning("W0668", {},
                 fmt::format("{}; {:.2g} % of the image show a rough preview", why,
                             100 * static_cast<double>(missing.pixels) / static_cast<double>(missing.image.area())))
        .help =
        missing.allBegun ? "W0640 says what was dropped and where" : "give it more `--time`, or a smaller `--size`";
}

void warnOfMissingLight(const RenderStatistics& statistics, Diagnostics& diagnostics) {
    const bool noLightPaths =
        statistics.caustics.of<LightPathFindings>().used() && statistics.splats == 0 && statistics.lightPaths == 0;
    const bool noRounds = statistics.caustics.of<MergeFindings>().used && statistics.rounds == 0;
    if (!noLightPaths && !noRounds) return;
    diagnostics
        .warning("W0669", {},
                 fmt::format("the render was ended before {}; their light is missing",
                             noLightPaths ? "its first light paths" : "its first round of merged light paths"))
        .help = "give it more time, or `light-paths off` and `merging off`";
}

void warnOfHeavyTail(const ErrorFigure& error, Diagnostics& diagnostics) {
    if (error.unseen <= TailEstimate::kTrusted) return;
    Diagnostic& d = diagnostics.warning(
        "W0649", {},
        fmt::format(
            "few samples carry the noise (Pareto k {:.2g}): the error may be {:.2g} times what the samples show, "
            "and error bars of {} of {} tiles cannot be trusted",
            error.tail, std::sqrt(1 + error.unseen), error.untrustedTiles, error.tiles));
    const PixelBounds& b = error.worst.pixels;
    d.notes.push_back(fmt::format("most noise is at {},{} to {},{}", b.x0, b.y0, b.x1, b.y1));
    d.help = "light of a small source that glossy surfaces or glass gather or mirror does this: more samples, a larger "
             "source or a rougher surface, or `render { light-paths always }`";
}

void warnOfBlackImage(const ResolvedImage& image, Diagnostics& diagnostics) {
    const auto black = [](const std::vector<float>& plane) {
        return std::all_of(plane.begin(), plane.end(), [](float v) { return v == 0; });
    };
    if (black(image.r) && black(image.g) && black(image.b))
        diagnostics.warning("W0641", {}, "every pixel of the image is black").help =
            "no light reaches the camera: check where the camera looks, which side the lights face, and what "
            "encloses them";
}

void warnOfDisplay(const PictureFigures& figures, const ShownStops& stops, Span camera, Diagnostics& diagnostics) {
    if (!figures.missingStops || !figures.display) return;
    const bool white = *figures.missingStops < 0;
    const double share = white ? figures.display->white : figures.display->black;
    const std::string png = std::filesystem::path(stops.image).replace_extension(".png").string();
    diagnostics
        .warning("W0644", camera,
                 fmt::format("{:.3g} % of the picture is {} on the display", 100 * share, white ? "white" : "black"),
                 fmt::format("its exposure is {:g} stops", stops.camera))
        .help = fmt::format("write `exposure {:.1f} stops`, or `exposure auto`; to see this picture as it is, `abbe "
                            "convert {} {} --exposure {:.1f}`",
                            stops.camera + *figures.missingStops, shellQuoted(stops.image), shellQuoted(png),
                            stops.view + *figures.missingStops);
}

namespace {

std::string quotedName(const void* thing, const Scene& scene) {
    for (const auto& medium : scene.media)
        if (medium.get() == thing) return fmt::format("`{}`", scene.mediumUses[medium->number].name);
    const auto found = scene.names.find(thing);
    return found == scene.names.end() ? std::string("a shape") : fmt::format("`{}`", found->second);
}

Span placeOf(const void* thing, const BuiltScene& built) {
    const auto found = built.declared.find(thing);
    return found == built.declared.end() ? Span{} : found->second;
}

// The first one is where the diagnostic is.
std::string list(const std::vector<const void*>& things, const BuiltScene& built, Diagnostic& d) {
    std::vector<std::string> names;
    for (const void* thing : things) {
        names.push_back(quotedName(thing, built.scene));
        if (const Span place = placeOf(thing, built); place.valid() && thing != things[0])
            d.related.push_back({place, "and here"});
    }
    return fmt::format("{}", fmt::join(names, ", "));
}

} // namespace

void warnOfEndlessPaths(const FramePreview& look, const BuiltScene& built, double samples, Diagnostics& diagnostics) {
    const std::vector<const void*> shapes(look.endless.shapes.begin(), look.endless.shapes.end());
    if (shapes.empty()) return;
    Diagnostic& d = diagnostics.warning("W0647", placeOf(shapes[0], built), {}, "takes no light away");
    d.message = fmt::format("paths go round without losing light: {:.0f} rays each in the mean, of {}", look.raysOfPath,
                            list(shapes, built, d));
    const double seconds = look.secondsForSample * samples;
    d.notes.push_back(fmt::format("where they are longest {:.0f} % have more than 64 vertices, and are ended by chance",
                                  100 * look.endless.share));
    if (seconds > 0) d.notes.push_back(fmt::format("as it is, the render takes about {}", clockText(seconds)));
    d.help = "nothing real sends back all light: a reflectance of 0.98 or an inside that absorbs ends them; `max-depth "
             "100` in `render` cuts them off";
}

void warnOfCappedPaths(const RenderStatistics& statistics, const BuiltScene& built, Diagnostics& diagnostics) {
    if (statistics.cappedPaths == 0) return;
    std::vector<const void*> places;
    for (const auto& [place, count] : statistics.cappedIn) places.push_back(place);
    std::ranges::sort(places, [&](const void* a, const void* b) {
        const auto count = [&](const void* p) { return statistics.cappedIn.at(p); };
        return count(a) != count(b) ? count(a) > count(b) : quotedName(a, built.scene) < quotedName(b, built.scene);
    });
    if (places.size() > 4) places.resize(4);
    const auto paths = static_cast<double>(statistics.paths + statistics.lightPaths);
    Diagnostic& d = diagnostics.warning("W0642", places.empty() ? Span{} : placeOf(places[0], built), {});
    d.message =
        fmt::format("{} paths ({:.2g} %) were cut at the safety cap on vertices{}; the light that they would have "
                    "found is missing",
                    statistics.cappedPaths, 100 * static_cast<double>(statistics.cappedPaths) / paths,
                    places.empty() ? "" : ", in " + list(places, built, d));
    d.help = "nothing there absorbs: a reflectance or an albedo a little below 1 ends them";
}

} // namespace abbe
