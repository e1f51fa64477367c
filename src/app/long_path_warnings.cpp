#include "app/long_path_warnings.h"

#include "app/progress_text.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace abbe {

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

void warnOfEndlessPaths(const FirstLook& look, const BuiltScene& built, double samples, Diagnostics& diagnostics) {
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
