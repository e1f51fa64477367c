// Every technique makes the same picture: each against the default, on scenes that need all of the loop. Surfaces of
// all kinds, dispersion, media, textures and lights that only some techniques can find.
#include "support/environment_file.h"
#include "support/open_box.h"
#include "support/scene_test.h"
#include "support/scene_test_compare.h"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <map>

namespace abbe::test {
namespace {

constexpr const char* kTechniqueHeader = "scene 1\nfilm { size 24 24; filter box 0.5 }\n";
const std::string kTechniqueLight =
    "light quad { points -0.8 0.9 0.7  -0.8 0.9 -0.8  0.8 0.9 -0.8  0.8 0.9 0.7; radiance 2 }\n"
    "light sphere { center -0.7 -0.3 0.5; radius 0.15; radiance 3 }\n";

struct TechniqueScene {
    std::string text;
    std::uint32_t samples = 256;
    std::uint32_t maxDepth = 0;
};

// Matte, rough metal, and gloss over a matte ground: a delta lobe beside others.
TechniqueScene surfaces() {
    return {kOpenBox + kTechniqueLight +
            "shape sphere { center -0.4 -0.55 0; radius 0.42; material conductor { index metal Au; roughness 0.6 } }\n"
            "shape sphere { center 0.5 -0.55 0.1; radius 0.42; material openpbr { base-color 0.5; specular-roughness 0 "
            "} }\n"};
}
// Rough dispersive glass, whose densities depend on wavelength.
TechniqueScene roughGlass() {
    return {kOpenBox + kTechniqueLight +
                "shape sphere { center 0 -0.45 0; radius 0.5; material dielectric { ior cauchy 1.4 0.03; roughness 0.9;"
                " absorption table 400 0.5 700 0.1 } }\n",
            768};
}
// Polished glass, which ends all wavelengths but one.
TechniqueScene polishedGlass() {
    return {kOpenBox + kTechniqueLight +
                "shape sphere { center 0.3 -0.6 0.2; radius 0.35; material dielectric { ior glass SF11 } }\n",
            512};
}
// Fog whose extinction depends on wavelength, a light in it, and a diffuse transmitter.
TechniqueScene fog() {
    return {
        kOpenBox + kTechniqueLight +
            "volume atmosphere { scattering table 400 0.5 700 0.2; absorption 0.05; phase henyey-greenstein { g 0.4 "
            "} }\n"
            "shape quad { points -0.5 -0.4 0.2  0.5 -0.4 0.2  0.5 0.3 -0.1  -0.5 0.3 -0.1; material "
            "diffuse-transmission { reflectance 0.3; transmittance 0.5 } }\n",
        512};
}

TestImage renderWith(const TestScene& scene, const TechniqueScene& s, const Technique& technique, std::uint64_t seed) {
    RenderSettings settings = scene.settings();
    settings.samples = nightly() ? 8 * s.samples : s.samples / 2;
    settings.seed = seed;
    settings.maxDepth = s.maxDepth;
    settings.technique = technique;
    return render(scene, settings);
}

// All choices that differ from the default, one at a time, and some together.
std::map<std::string, Technique> techniques() {
    using T = Technique;
    std::map<std::string, Technique> all;
    all["stratified"].numbers = T::Numbers::stratified;
    all["random"].numbers = T::Numbers::random;
    all["power weights"].weights = T::Weights::power;
    all["equal weights"].weights = T::Weights::equal;
    all["weights that favour lights"].weights = T::Weights::lights;
    all["weights that favour scattering"].weights = T::Weights::scattering;
    all["uniform directions"].directions = T::Directions::uniform;
    all["mixed directions"].directions = T::Directions::mixed;
    all["mixed, lights"] = {.weights = T::Weights::lights, .directions = T::Directions::mixed};
    all["mixed, scattering"] = {.weights = T::Weights::scattering, .directions = T::Directions::mixed};
    all["roulette by throughput"].roulette = T::Roulette::throughput;
    all["no roulette"].roulette = T::Roulette::off;
    for (const int n : {1, 2, 4}) all[fmt::format("{} wavelengths", n)].wavelengths = static_cast<std::uint8_t>(n);
    all["all others"] = {T::Numbers::stratified,
                         T::Strategy::mis,
                         T::Weights::power,
                         T::Directions::uniform,
                         T::LightChoice::power,
                         T::Roulette::throughput,
                         4};
    all["uniform, lights"] = {.strategy = T::Strategy::lightsOnly, .directions = T::Directions::uniform};
    all["uniform, equal"] = {.weights = T::Weights::equal, .directions = T::Directions::uniform, .wavelengths = 1};
    return all;
}

// Of the mean of the image. Even directions rarely meet small lights and narrow lobes, one wavelength is coloured
// noise.
double resolution(const Technique& t) {
    const double of = nightly() ? 1 : 1.5;
    if (t.directions == Technique::Directions::uniform)
        return of * (t.weights == Technique::Weights::equal ? 0.06 : 0.025);
    return of * (t.wavelengths == 1 ? 0.015 : 0.008);
}

// Without `all` every second one. Without `uniform` only those of importance sampling. Even directions square the
// weight of a narrow lobe at each bounce on average by more than what leaves: inside rough glass, and where caustics
// fall, their variance is without bound.
void checkTechniques(const TechniqueScene& s, bool uniform = true, bool all = true) {
    const auto scene = TestScene::parse(kTechniqueHeader + s.text);
    // Longer than what it is compared with, for all the comparisons' sake.
    const TestImage usual = renderWith(scene, {s.text, 4 * s.samples, s.maxDepth}, {}, 1);
    std::uint64_t seed = 2;
    int skipped = 0;
    for (const auto& [name, technique] : techniques()) {
        if (!all && ++skipped % 2 == 1) continue;
        if (!uniform && technique.directions == Technique::Directions::uniform) continue;
        INFO(name);
        const TestImage other = renderWith(scene, s, technique, ++seed);
        for (const Channel channel : {Channel::y, Channel::x, Channel::z})
            checkSame(compareImages(other.film, usual.film, channel), resolution(technique));
        CHECK(other.statistics.dropped == std::array<std::uint64_t, 3>{});
        CHECK(other.statistics.cappedPaths == 0);
    }
}

} // namespace

TEST_CASE("techniques: surfaces of all kinds") { checkTechniques(surfaces()); }
TEST_CASE("techniques: rough glass that disperses") { checkTechniques(roughGlass(), false); }
TEST_CASE("techniques: rough glass that disperses, few bounces") {
    TechniqueScene s = roughGlass();
    s.maxDepth = 2;
    checkTechniques(s);
}
TEST_CASE("techniques: polished glass that disperses") { checkTechniques(polishedGlass(), false); }
TEST_CASE("techniques: coloured fog and translucent things") { checkTechniques(fog(), true, nightly()); }

// Compensation takes most of a picture out of what lights are asked for: `lights` must find it nevertheless.
TEST_CASE("techniques: what a light is never asked for is found by scattering") {
    const auto path = std::filesystem::temp_directory_path() / "abbe_technique_environment.exr";
    writeEnvironment(path.string(), 32, 16, [](int x, int y) -> std::array<float, 3> {
        if (x >= 5 && x < 11 && y >= 3 && y < 7) return {9, 7, 2};
        return {0.2f + 0.02f * static_cast<float>(y), 0.3f, 0.5f - 0.01f * static_cast<float>(x)};
    });
    const TechniqueScene s{fmt::format("camera {{ from 0 3 4; look-at 0 0.3 0; fov 32 deg }}\n"
                                       "light environment \"{}\"\n"
                                       "shape plane {{ material diffuse {{ reflectance 0.6 }} }}\n"
                                       "shape sphere {{ center 0 0.5 0; radius 0.5; material conductor {{ index metal "
                                       "Al; roughness 0.6 }} }}\n",
                                       path.string()),
                           1024};
    const auto scene = TestScene::parse(kTechniqueHeader + s.text);
    const TestImage usual = renderWith(scene, s, {}, 1);
    std::uint64_t seed = 2;
    for (const auto strategy : {Technique::Strategy::lightsOnly, Technique::Strategy::bsdfOnly})
        checkSame(compareImages(renderWith(scene, s, {.strategy = strategy}, ++seed).film, usual.film));
    for (const auto weights : {Technique::Weights::power, Technique::Weights::equal})
        checkSame(compareImages(renderWith(scene, s, {.weights = weights}, ++seed).film, usual.film));
    std::filesystem::remove(path);
}

// Nothing is absorbed and nothing leaves: only the rule for long paths ends them, and light from the light adds up to
// no end but for the light itself, which is black.
TEST_CASE("techniques: paths end in a closed white box, whatever the roulette") {
    std::string text = "scene 1\nfilm { size 4 4; filter box 0.5 }\n" + kOpenBox +
                       "shape front quad { material white; points -1 -1 5  -1 1 5  1 1 5  1 -1 5 }\n"
                       "shape a quad { material white; points -1 -1 5  1 -1 5  1 -1 1  -1 -1 1 }\n"
                       "shape b quad { material white; points -1 1 1  1 1 1  1 1 5  -1 1 5 }\n"
                       "shape c quad { material white; points -1 -1 5  -1 -1 1  -1 1 1  -1 1 5 }\n"
                       "shape d quad { material white; points 1 -1 1  1 -1 5  1 1 5  1 1 1 }\n"
                       "light sphere { center 0 0.5 0; radius 0.2; radiance 1 }\n";
    for (const char* from : {"rgb 0.7 0.1 0.1", "rgb 0.1 0.6 0.1", "0.7"})
        for (std::size_t at; (at = text.find(from)) != std::string::npos;)
            text.replace(at, std::string(from).size(), "1");
    const auto scene = TestScene::parse(text);
    for (const auto roulette :
         {Technique::Roulette::pilot, Technique::Roulette::throughput, Technique::Roulette::off}) {
        RenderSettings settings = scene.settings();
        settings.samples = 16;
        settings.technique.roulette = roulette;
        const TestImage image = render(scene, settings);
        CHECK(image.statistics.cappedPaths == 0);
        CHECK(image.statistics.vertices < 3000 * image.statistics.paths);
        CHECK(image.statistics.dropped == std::array<std::uint64_t, 3>{});
    }
}

} // namespace abbe::test
