#include "study/study_variant.h"

#include "integrators/light_sampler.h"

#include <algorithm>
#include <array>

namespace abbe {

namespace {

using Reason = std::optional<std::string>;

bool sameMeans(const RenderSettings& a, const RenderSettings& b) {
    return a.technique == b.technique && a.adaptive == b.adaptive;
}

Reason needsLights(const StudySubject& s) {
    if (LightSampler(s.built->scene.lights).empty()) return "no light can be sampled";
    return std::nullopt;
}

// A light without extent is never met by chance: a path tracer that only scatters loses it.
bool isPoint(const Light& light, const Vec3& from, const Wavelengths& wavelengths) {
    for (std::uint32_t i = 0; i < 8; ++i) {
        const Vec2 u((static_cast<float>(i) + 0.5f) / 8, 0.5f);
        const auto sample = light.sample(Receiver(from), 0, u, wavelengths, 0);
        if (sample) return sample->delta;
    }
    return false;
}

Reason needsExtent(const StudySubject& s) {
    if (const Reason reason = needsLights(s)) return reason;
    const Scene& scene = s.built->scene;
    const Wavelengths wavelengths = scene.wavelengths.sample(0.5f);
    for (const auto& light : scene.lights)
        for (const Vec3 from : {Vec3(0, 0, 0), Vec3(0.1f, 0.2f, -0.3f)})
            if (light->power() > 0 && isPoint(*light, from, wavelengths))
                return "a light without extent cannot be met by chance, so its light would be lost";
    return std::nullopt;
}

Reason needsManyLights(const StudySubject& s) {
    if (!LightSampler(s.built->scene.lights).needsChoice()) return "there is one light, so there is no choice";
    return std::nullopt;
}

Reason needsHalves(const StudySubject& s) {
    if (s.replicates < 2) return "the denoiser needs two replicates or more to tell noise from detail";
    return std::nullopt;
}

using S = RenderSettings;
using T = Technique;
using enum BiasClass;

} // namespace

std::string_view name(BiasClass b) {
    constexpr std::array<std::string_view, 3> kNames{"exact", "consistent", "biased"};
    return kNames[static_cast<std::size_t>(b)];
}

const std::vector<StudyVariant>& studyVariants() {
    static const std::vector<StudyVariant> variants{
        {"abbe", "as rendered", "main", "nothing changed", exact, ""},
        {"no-nee", "no light sampling", "light sampling", "light is met by chance alone", exact,
         "no next-event estimation: what is left are the directions that surfaces prefer",
         [](S& s) { s.technique.strategy = T::Strategy::bsdfOnly; }, false, needsExtent},
        {"lights-only", "light sampling alone", "light sampling", "light that is met by chance does not count", exact,
         "behind mirrors and glass, where sampling a light cannot work, met light counts still",
         [](S& s) { s.technique.strategy = T::Strategy::lightsOnly; }, false, needsLights},
        {"power-weights", "power heuristic", "light sampling", "the two ways to find light weighed by squares", exact,
         "", [](S& s) { s.technique.weights = T::Weights::power; }, false, needsLights},
        {"no-mis", "no MIS", "light sampling", "the two ways to find light count one half each", exact,
         "where only one of them can find it, that one counts in full",
         [](S& s) { s.technique.weights = T::Weights::equal; }, false, needsLights},
        {"uniform-directions", "uniform directions", "directions", "paths go on evenly all around", exact,
         "mirrors and clear glass are followed still; inside rough glass the variance has no bound",
         [](S& s) { s.technique.directions = T::Directions::uniform; }},
        {"roulette-throughput", "roulette by throughput", "roulette", "paths live by what they carry alone", exact, "",
         [](S& s) { s.technique.roulette = T::Roulette::throughput; }},
        {"no-roulette", "no roulette", "roulette", "paths end when they carry next to nothing", exact,
         "paths of more than 64 vertices are never certain to go on",
         [](S& s) { s.technique.roulette = T::Roulette::off; }},
        {"wavelengths-1", "1 wavelength", "wavelengths", "each path has one wavelength", exact, "",
         [](S& s) { s.technique.wavelengths = 1; }},
        {"wavelengths-4", "4 wavelengths", "wavelengths", "each path has four wavelengths", exact, "",
         [](S& s) { s.technique.wavelengths = 4; }},
        {"stratified", "stratified numbers", "numbers", "jittered strata, as many as the samples of a replicate", exact,
         "every rung is a render of its own", [](S& s) { s.technique.numbers = T::Numbers::stratified; }},
        {"sobol", "Owen–Sobol numbers", "numbers", "Owen-scrambled Sobol points", exact, "",
         [](S& s) { s.technique.numbers = T::Numbers::sobol; }},
        {"random", "independent numbers", "numbers", "independent random numbers", exact, "",
         [](S& s) { s.technique.numbers = T::Numbers::random; }},
        {"light-tree", "light tree", "light choice", "lights are asked by what they may give to the place", exact, "",
         [](S& s) { s.technique.lightChoice = T::LightChoice::tree; }, false, needsManyLights},
        {"light-power", "lights by power", "light choice", "lights are asked by their power", exact, "",
         [](S& s) { s.technique.lightChoice = T::LightChoice::power; }, false, needsManyLights},
        {"light-uniform", "lights evenly", "light choice", "each light is asked as often", exact, "",
         [](S& s) { s.technique.lightChoice = T::LightChoice::uniform; }, false, needsManyLights},
        {"adaptive", "adaptive samples", "numbers", "more samples where a pilot finds more noise", exact,
         "a rung has its samples on average over the pixels; the pilot's time counts", [](S& s) { s.adaptive = true; }},
        {"even", "even samples", "numbers", "the same samples for each pixel", exact, "",
         [](S& s) { s.adaptive = false; }},
        {"denoised", "denoised", "post", "each image goes through the denoiser", biased,
         "the time of its layers and of the denoiser counts", nullptr, true, needsHalves},
    };
    return variants;
}

ChosenVariants chooseVariants(const StudySubject& subject, const std::vector<std::string>& ids) {
    ChosenVariants chosen;
    for (const StudyVariant& variant : studyVariants()) {
        const bool main = chosen.variants.empty();
        if (!main && std::find(ids.begin(), ids.end(), variant.id) == ids.end()) continue;
        Reason reason = variant.needless ? variant.needless(subject) : std::nullopt;
        if (!main && !reason && !variant.denoised && sameMeans(subject.settings, variant.settings(subject.settings))) {
            if (ids.size() >= studyVariants().size()) continue; // nobody asked for this one
            reason = "the scene is rendered like that: it is the main curve";
        }
        if (reason)
            chosen.leftOut.push_back({variant.id, variant.label, *reason});
        else
            chosen.variants.push_back(variant);
    }
    return chosen;
}

} // namespace abbe
