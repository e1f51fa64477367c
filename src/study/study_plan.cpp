#include "study/study_plan.h"

#include "base/check.h"
#include "caustics/light_tracing/light_path_plan.h"
#include "caustics/merging/merge_plan.h"
#include "film/pixel_film.h"
#include "light_sampling/light_sampler.h"
#include "math/hash.h"
#include "rendering/path_tracer.h"

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
    if (light.neverHit()) return true;
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
    if (scene.hidden.splits) return "scattering meets shapes that do not shade (`visible-to`)";
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

CausticFindings causticsOf(const StudySubject& s, const RenderSettings& settings) {
    const Scene& scene = s.built->scene;
    const PixelFilm like({0, 0, 1, 1}, PixelFilter(s.film.filter, s.film.filterRadius), s.replicates);
    return makePathTracer(scene.effects)->findCaustics(scene, like, settings);
}

// What is done about light paths where the scene leaves it to the program.
LightPathVerdict automaticLightPaths(const StudySubject& s) {
    RenderSettings settings = s.settings;
    settings.technique.lightPaths = Technique::LightPaths::automatic;
    return causticsOf(s, settings).of<LightPathFindings>().verdict;
}

Reason needsLightPaths(const StudySubject& s) {
    using enum LightPathVerdict;
    switch (automaticLightPaths(s)) {
    case noLights:
        return "no light can start light paths";
    case nothingFocuses:
        return "nothing focuses light";
    case hiddenShapes:
        return "shadows and reflections see different shapes";
    case otherTechnique:
        return "light paths do not go with another technique of `render`";
    default:
        return std::nullopt;
    }
}

Reason needsUsedLightPaths(const StudySubject& s) {
    if (const Reason reason = needsLightPaths(s)) return reason;
    if (s.settings.technique.lightPaths == Technique::LightPaths::automatic &&
        automaticLightPaths(s) != LightPathVerdict::used)
        return "the scene is rendered without light paths as it is";
    return std::nullopt;
}

// What is merged where the scene leaves it to the program.
Reason needsUsedMerging(const StudySubject& s) {
    if (const Reason reason = needsLightPaths(s)) return reason;
    if (s.settings.technique.merging == Technique::Merging::off) return "`merging off` of `render`";
    if (!causticsOf(s, s.settings).of<MergeFindings>().used) return "no light is merged";
    return std::nullopt;
}

Reason needsUnusedLightPaths(const StudySubject& s) {
    if (const Reason reason = needsLightPaths(s)) return reason;
    if (s.settings.technique.lightPaths == Technique::LightPaths::automatic &&
        automaticLightPaths(s) == LightPathVerdict::used)
        return "the scene is rendered with light paths as it is";
    return std::nullopt;
}

using S = RenderSettings;
using T = Technique;
using enum BiasClass;

std::vector<StudyVariant> lightSampling() {
    constexpr const char* kGroup = "light sampling";
    return {
        {"no-nee", "no light sampling", kGroup, "light is met by chance alone", exact,
         "no next-event estimation: paths find lights only by hitting them",
         [](S& s) { s.technique.strategy = T::Strategy::bsdfOnly; }, false, needsExtent},
        {"lights-only", "light sampling alone", kGroup, "light that is met by chance does not count", exact,
         "behind mirrors and glass, where sampling a light cannot work, met light counts still",
         [](S& s) { s.technique.strategy = T::Strategy::lightsOnly; }, false, needsLights},
        {"mis", "both, by MIS", kGroup, "lights are sampled and met, weighted against each other", exact, "",
         [](S& s) { s.technique.strategy = T::Strategy::mis; }, false, needsLights},
        {"no-mis", "no MIS", kGroup, "sampled and met light count half each", exact,
         "both ways to find light without multiple importance sampling; where only one can, that one counts in full",
         [](S& s) {
             s.technique.strategy = T::Strategy::mis;
             s.technique.weights = T::Weights::equal;
         },
         false, needsLights},
        {"power-weights", "power heuristic", kGroup, "MIS weights by squares of densities", exact, "",
         [](S& s) { s.technique.weights = T::Weights::power; }, false, needsLights},
        {"balance-weights", "balance heuristic", kGroup, "MIS weights by densities", exact, "",
         [](S& s) { s.technique.weights = T::Weights::balance; }, false, needsLights},
    };
}

std::vector<StudyVariant> directions() {
    constexpr const char* kGroup = "directions";
    return {
        {"uniform-directions", "uniform directions", kGroup, "paths go on evenly in all directions", exact,
         "no importance sampling of materials; mirrors and clear glass are followed still; inside rough glass the "
         "variance has no bound",
         [](S& s) { s.technique.directions = T::Directions::uniform; }},
        {"importance-directions", "directions by importance", kGroup, "paths go on as the material scatters", exact, "",
         [](S& s) { s.technique.directions = T::Directions::importance; }},
    };
}

std::vector<StudyVariant> numbers() {
    constexpr const char* kGroup = "numbers";
    return {
        {"sobol", "Owen–Sobol numbers", kGroup, "Owen-scrambled Sobol points", exact, "",
         [](S& s) { s.technique.numbers = T::Numbers::sobol; }},
        {"stratified", "stratified numbers", kGroup, "jittered strata in pairs of dimensions", exact,
         "strata depend on how many samples there will be, so each rung is a render of its own",
         [](S& s) { s.technique.numbers = T::Numbers::stratified; }},
        {"random", "independent numbers", kGroup, "independent random numbers", exact, "",
         [](S& s) { s.technique.numbers = T::Numbers::random; }},
        {"adaptive", "adaptive samples", kGroup, "more samples where a pilot finds more noise", exact,
         "a rung has its samples on average over the pixels; the pilot's time counts", [](S& s) { s.adaptive = true; }},
        {"even", "even samples", kGroup, "the same samples for each pixel", exact, "",
         [](S& s) { s.adaptive = false; }},
    };
}

std::vector<StudyVariant> wavelengths() {
    constexpr const char* kGroup = "wavelengths";
    return {
        {"wavelengths-1", "1 wavelength", kGroup, "one wavelength for each path", exact, "",
         [](S& s) { s.technique.wavelengths = 1; }},
        {"wavelengths-4", "4 wavelengths", kGroup, "four wavelengths for each path", exact, "",
         [](S& s) { s.technique.wavelengths = 4; }},
        {"wavelengths-8", "8 wavelengths", kGroup, "eight wavelengths for each path", exact, "",
         [](S& s) { s.technique.wavelengths = 8; }},
    };
}

std::vector<StudyVariant> roulette() {
    constexpr const char* kGroup = "roulette";
    return {
        {"no-roulette", "no roulette", kGroup, "only paths that carry next to nothing are ended", exact,
         "paths of more than 64 vertices are never certain to go on",
         [](S& s) { s.technique.roulette = T::Roulette::off; }},
        {"roulette-throughput", "roulette by throughput", kGroup, "paths end by what they carry", exact, "",
         [](S& s) { s.technique.roulette = T::Roulette::throughput; }},
        {"roulette-pilot", "roulette by contribution", kGroup, "paths end by what their pixel is expected to show",
         exact, "", [](S& s) { s.technique.roulette = T::Roulette::pilot; }},
    };
}

std::vector<StudyVariant> lightChoice() {
    constexpr const char* kGroup = "light choice";
    return {
        {"light-tree", "light tree", kGroup, "next-event estimation chooses lights by what they may give to the place",
         exact, "", [](S& s) { s.technique.lightChoice = T::LightChoice::tree; }, false, needsManyLights},
        {"light-power", "lights by power", kGroup, "next-event estimation chooses lights by their power", exact, "",
         [](S& s) { s.technique.lightChoice = T::LightChoice::power; }, false, needsManyLights},
        {"light-uniform", "lights evenly", kGroup, "next-event estimation chooses each light equally often", exact, "",
         [](S& s) { s.technique.lightChoice = T::LightChoice::uniform; }, false, needsManyLights},
    };
}

std::vector<StudyVariant> lightPaths() {
    constexpr const char* kGroup = "light paths";
    return {
        {"light-paths-off", "no light paths", kGroup, "caustics are found by camera paths alone", exact,
         "what camera paths hardly ever find is missing from most of the images, and from the estimates of their "
         "errors",
         [](S& s) { s.technique.lightPaths = T::LightPaths::off; }, false, needsUsedLightPaths},
        {"merging-off", "no merging", kGroup, "caustics behind glass and in mirrors without photons", exact,
         "what camera paths hardly ever find is missing from most of the images, and from the estimates of their "
         "errors",
         [](S& s) { s.technique.merging = T::Merging::off; }, false, needsUsedMerging},
        {"light-paths-always", "light paths in any case", kGroup,
         "light paths, whether they are forecast to pay or not", exact, "",
         [](S& s) { s.technique.lightPaths = T::LightPaths::always; }, false, needsUnusedLightPaths},
    };
}

} // namespace

std::string_view name(BiasClass b) {
    constexpr std::array<std::string_view, 3> kNames{"exact", "consistent", "biased"};
    return kNames[static_cast<std::size_t>(b)];
}

const std::vector<StudyVariant>& studyVariants() {
    static const std::vector<StudyVariant> variants = [] {
        std::vector<StudyVariant> all{{"abbe", "as rendered", "main", "nothing changed", exact, ""}};
        for (const auto& group :
             {lightSampling(), directions(), numbers(), wavelengths(), roulette(), lightChoice(), lightPaths()})
            all.insert(all.end(), group.begin(), group.end());
        all.push_back({"denoised", "denoised", "post", "each image goes through the denoiser", biased,
                       "the time of its layers and of the denoiser counts", nullptr, true, needsHalves});
        return all;
    }();
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

std::vector<std::uint32_t> StudyPlan::ladder(std::uint32_t samples, int replicates) {
    ABBE_CHECK(replicates >= 1);
    const auto r = static_cast<std::uint64_t>(replicates);
    std::uint64_t each = 1; // samples of a replicate
    while (each * r < 4) each *= 2;
    std::vector<std::uint32_t> rungs;
    for (; each * r <= samples; each *= 2) rungs.push_back(static_cast<std::uint32_t>(each * r));
    return rungs;
}

std::uint64_t StudyPlan::referenceSeed(int half) const {
    constexpr std::uint64_t kReference = 0x7265666572; // "refer"
    constexpr std::uint64_t kLargest = (std::uint64_t(1) << 53) - 1;
    return combine64(combine64(kReference, seed), static_cast<std::uint64_t>(half)) & kLargest;
}

} // namespace abbe
