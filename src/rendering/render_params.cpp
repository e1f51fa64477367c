#include "rendering/render_params.h"

namespace abbe {

namespace {

constexpr std::string_view kNumberWords[] = {"sobol", "stratified", "random"};
constexpr std::string_view kStrategyWords[] = {"mis", "lights", "bsdf"};
constexpr std::string_view kWeightWords[] = {"balance", "power", "equal", "lights", "scattering"};
constexpr std::string_view kDirectionWords[] = {"importance", "uniform", "mixed"};
constexpr std::string_view kLightChoiceWords[] = {"tree", "power", "uniform"};
constexpr std::string_view kRouletteWords[] = {"pilot", "throughput", "off"};
constexpr std::string_view kLightPathWords[] = {"automatic", "off", "always", "alone"};
constexpr std::string_view kMergingWords[] = {"automatic", "off", "always"};
constexpr std::string_view kGuidingWords[] = {"automatic", "off", "always"};
constexpr std::string_view kWindowWords[] = {"stated", "automatic"};

} // namespace

template <> std::span<const std::string_view> words<Technique::Numbers>() { return kNumberWords; }
template <> std::span<const std::string_view> words<Technique::Strategy>() { return kStrategyWords; }
template <> std::span<const std::string_view> words<Technique::Weights>() { return kWeightWords; }
template <> std::span<const std::string_view> words<Technique::Directions>() { return kDirectionWords; }
template <> std::span<const std::string_view> words<Technique::LightChoice>() { return kLightChoiceWords; }
template <> std::span<const std::string_view> words<Technique::Roulette>() { return kRouletteWords; }
template <> std::span<const std::string_view> words<Technique::LightPaths>() { return kLightPathWords; }
template <> std::span<const std::string_view> words<Technique::Merging>() { return kMergingWords; }
template <> std::span<const std::string_view> words<Technique::Guiding>() { return kGuidingWords; }
template <> std::span<const std::string_view> words<Technique::Windows>() { return kWindowWords; }

std::vector<std::pair<std::string, std::string>> properties(const Technique& t) {
    const auto text = [](auto e) { return std::string(word(e)); };
    return {{"sampler", text(t.numbers)},
            {"strategy", text(t.strategy)},
            {"mis-weights", text(t.weights)},
            {"directions", text(t.directions)},
            {"light-choice", text(t.lightChoice)},
            {"roulette", text(t.roulette)},
            {"light-paths", text(t.lightPaths)},
            {"merging", text(t.merging)},
            {"guiding", text(t.guiding)},
            {"windows", text(t.windows)},
            {"wavelengths", std::to_string(t.wavelengths)}};
}

using namespace schema;

namespace {

using P = RenderParams;

constexpr std::int64_t kSeeds = 9007199254740992; // 2^53: whole numbers that a double holds

std::vector<FieldInfo> goalFields() {
    return {
        field(FieldType::choice, "integrator", &P::integrator)
            .choices({"path"})
            .byDefault("path")
            .doc("Algorithm: path tracing with next-event estimation.")
            .example("integrator path"),
        field(FieldType::integer, "samples", &P::samples)
            .range(1, 4294967295.0)
            .byDefault("64")
            .synonyms({"spp", "pixelsamples", "sample_count"})
            .doc("Samples per pixel; the render ends here unless another goal is met before.")
            .example("samples 256"),
        field(FieldType::quantity, "noise", &P::noise)
            .unit({Dimension::fraction})
            .range(0, 1)
            .byDefault("0 %")
            .synonyms({"threshold", "noise-threshold", "adaptive_threshold"})
            .doc("Relative error of the image at which to stop; 0: none.")
            .example("noise 0.5 %"),
        field(FieldType::quantity, "time-limit", &P::timeLimit)
            .unit({Dimension::time})
            .range(0, 1e9)
            .byDefault("0 s")
            .doc("Wall-clock time after which to stop; 0: none.")
            .example("time-limit 45 min"),
        field(FieldType::number, "texture-cache", &P::textureCache)
            .range(16, 1e9)
            .byDefault("2048")
            .synonyms({"max_memory_MB", "texture-memory", "texturecache"})
            .doc("Most memory for tiles of image textures, in MiB; what does not fit is read again from disk.")
            .example("texture-cache 512"),
        field(FieldType::toggle, "adaptive", &P::adaptive)
            .byDefault("off")
            .synonyms({"adaptive-sampling", "use_adaptive_sampling"})
            .doc("More samples where a pilot finds more noise, fewer elsewhere; unbiased, at the same cost.")
            .example("adaptive on"),
        field(FieldType::number, "fps", &P::fps)
            .range(0.001, 1e6)
            .byDefault("24")
            .synonyms({"frame-rate", "framerate", "frames-per-second"})
            .doc("Frames of an animation in a second: with `--frames` frame N shows the moment N / fps.")
            .example("fps 25"),
        field(FieldType::table, "forbid", &P::forbid)
            .namedRows()
            .doc("Effects that this scene must not need; `abbe explain FILE --effects` lists all of them.")
            .example("forbid { motion; thin-film }"),
        field(FieldType::integer, "max-depth", &P::maxDepth)
            .range(0, 100000)
            .byDefault("0")
            .synonyms({"maxdepth", "max_depth", "bounces", "max-bounces", "depth"})
            .doc("Scattering events per path; 0: no limit, paths end by Russian roulette alone.")
            .example("max-depth 16"),
        field(FieldType::integer, "seed", &P::seed)
            .range(0, static_cast<double>(kSeeds))
            .byDefault("0")
            .doc("Chooses the random numbers; the same seed gives the same bits. The number of a frame comes to it.")
            .example("seed 7"),
        field(FieldType::integer, "replicates", &P::replicates)
            .range(1, 16)
            .byDefault("2")
            .doc("Independent sample sets whose spread gives the error bars; 8 for error bars per pixel.")
            .example("replicates 8")};
}

// How light is estimated: the same image by other means, to compare.
std::vector<FieldInfo> techniqueFields() {
    return {
        field(FieldType::choice, "sampler", &P::sampler)
            .words(words<Technique::Numbers>())
            .doc("Owen-scrambled Sobol points; jittered strata or independent random numbers to compare.")
            .example("sampler sobol"),
        field(FieldType::choice, "strategy", &P::strategy)
            .words(words<Technique::Strategy>())
            .doc("How light is found: by next-event estimation and BSDF sampling, or by one alone, to compare.")
            .example("strategy mis"),
        field(FieldType::choice, "mis-weights", &P::weights)
            .words(words<Technique::Weights>())
            .synonyms({"mis-heuristic", "heuristic"})
            .doc("How `strategy mis` weights its two techniques; all but `balance` are to compare.")
            .example("mis-weights power"),
        field(FieldType::choice, "directions", &P::directions)
            .words(words<Technique::Directions>())
            .doc("How directions are sampled: as the surface scatters; evenly, or by a mixture, to compare.")
            .example("directions uniform"),
        field(FieldType::choice, "roulette", &P::roulette)
            .words(words<Technique::Roulette>())
            .synonyms({"rr", "russian-roulette"})
            .doc("Russian roulette: by what the pixel shows; by throughput or none, to compare.")
            .example("roulette throughput"),
        field(FieldType::choice, "light-paths", &P::lightPaths)
            .words(words<Technique::LightPaths>())
            .synonyms({"caustics", "light-tracing", "photons"})
            .doc("Light tracing, for caustics: where it pays; never, always or alone, to compare.")
            .example("light-paths off"),
        field(FieldType::choice, "merging", &P::merging)
            .words(words<Technique::Merging>())
            .synonyms({"photon-map", "sppm", "vertex-merging"})
            .doc("Photon merging, for caustics behind glass and in mirrors that nothing else finds: biased.")
            .example("merging off"),
        field(FieldType::choice, "guiding", &P::guiding)
            .words(words<Technique::Guiding>())
            .synonyms({"path-guiding", "use_guiding"})
            .doc("Paths guided to where pilots found indirect light: where it pays; never or always, to compare.")
            .example("guiding off"),
        field(FieldType::choice, "windows", &P::windows)
            .words(words<Technique::Windows>())
            .synonyms({"portals"})
            .doc("Windows of a room through which skies are sampled: those that lights state as `portals`, or where "
                 "none does those that are found.")
            .example("windows automatic"),
        field(FieldType::integer, "wavelengths", &P::wavelengths)
            .range(1, 8)
            .byDefault("8")
            .doc("Different wavelengths of a path, 1, 2, 4 or 8; fewer to compare.")
            .example("wavelengths 4"),
        field(FieldType::choice, "light-choice", &P::lightChoice)
            .words(words<Technique::LightChoice>())
            .synonyms({"lightsampler", "light-sampler", "use_light_tree"})
            .doc("How a light is chosen: by what each may give to a point; by power or evenly, to compare.")
            .example("light-choice tree")};
}

} // namespace

TypeInfo renderType() {
    TypeInfo type{
        Kind::render, "settings",  "How long and by which means to render.", "render { samples 256; noise 0.5 % }",
        true,         goalFields()};
    for (FieldInfo& technique : techniqueFields()) type.fields.push_back(std::move(technique));
    return type;
}

std::int64_t seedOfFrame(std::int64_t seed, int frame) { return ((seed + frame) % kSeeds + kSeeds) % kSeeds; }

bool possibleWavelengths(std::int64_t count) { return count == 1 || count == 2 || count == 4 || count == 8; }

namespace {

Technique technique(const RenderParams& p) {
    Technique t;
    t.numbers = p.sampler;
    t.strategy = p.strategy;
    t.weights = p.weights;
    t.directions = p.directions;
    t.lightChoice = p.lightChoice;
    t.roulette = p.roulette;
    t.lightPaths = p.lightPaths;
    t.merging = p.merging;
    t.guiding = p.guiding;
    t.windows = p.windows;
    t.wavelengths = static_cast<std::uint8_t>(p.wavelengths);
    return t;
}

} // namespace

RenderSettings renderSettings(const RenderParams& p) {
    RenderSettings s;
    s.samples = static_cast<std::uint32_t>(p.samples);
    s.seed = static_cast<std::uint64_t>(p.seed);
    s.maxDepth = static_cast<std::uint32_t>(p.maxDepth);
    s.noiseTarget = p.noise;
    s.timeLimit = p.timeLimit;
    s.adaptive = p.adaptive;
    s.technique = technique(p);
    return s;
}

} // namespace abbe
