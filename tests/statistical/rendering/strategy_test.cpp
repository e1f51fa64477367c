// Next-event estimation alone, BSDF sampling alone and both together must make the same picture: three estimators that
// share neither densities nor weights.
#include "rendering/guide_plan.h"
#include "support/environment_file.h"
#include "support/open_box.h"
#include "support/scene_test.h"
#include "support/scene_test_compare.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

struct StrategyScene {
    const char* name;
    std::string text;
    std::uint32_t samples; // of every strategy
    std::uint32_t maxDepth = 0;
    double resolution = 0.0025;
    std::uint64_t seed = 1; // the first of three
};

constexpr const char* kStrategyHeader = "scene 1\nfilm { size 32 32; filter box 0.5 }\n";

TestImage renderWith(const StrategyScene& s, Technique::Strategy strategy, std::uint64_t seed) {
    BuildOptions options;
    options.strategy = strategy;
    const auto scene = TestScene::parse(kStrategyHeader + s.text, options);
    RenderSettings settings = scene.settings();
    settings.samples = nightly() ? 8 * s.samples : s.samples / 2;
    settings.maxDepth = s.maxDepth;
    settings.seed = seed;
    return render(scene, settings);
}

void checkStrategies(const StrategyScene& s) {
    INFO(std::string(s.name));
    const TestImage mis = renderWith(s, Strategy::mis, s.seed),
                    lights = renderWith(s, Strategy::lightsOnly, s.seed + 1),
                    bsdf = renderWith(s, Strategy::bsdfOnly, s.seed + 2);
    const double resolution = (nightly() ? 1 : 1.5) * s.resolution;
    for (const Channel channel : {Channel::y, Channel::x, Channel::z}) {
        INFO("lights alone against both");
        checkSame(compareImages(lights.film, mis.film, channel), resolution);
        INFO("BSDF alone against both");
        checkSame(compareImages(bsdf.film, mis.film, channel), resolution);
    }
    for (const TestImage* image : {&mis, &lights, &bsdf}) {
        CHECK(image->statistics.dropped == std::array<std::uint64_t, 3>{});
        CHECK(image->statistics.cappedPaths == 0);
    }
}

const std::string kLight = "light quad { points -0.8 0.9 0.7  -0.8 0.9 -0.8  0.8 0.9 -0.8  0.8 0.9 0.7; radiance 2 }\n";

} // namespace

TEST_CASE("strategies: matte box, quad light") {
    checkStrategies(
        {"box", kOpenBox + kLight + "shape sphere { center 0.3 -0.6 0; radius 0.4; material white }\n", 512});
}

// Seen is the room without a light, behind a wall with a gap of a tenth.
const std::string kTwoRooms = R"(scene 1
film { size 64 64; filter box 0.5 }
camera { from 0.9 0 0.95; look-at 0.5 -0.3 -1; fov 70 deg }
material white diffuse { reflectance 0.7 }
shape floor   quad { material white; points -1 -1 1   1 -1 1   1 -1 -1  -1 -1 -1 }
shape ceiling quad { material white; points -1 1 -1   1 1 -1   1 1 1    -1 1 1 }
shape back    quad { material white; points -1 -1 -1  1 -1 -1  1 1 -1   -1 1 -1 }
shape front   quad { material white; points -1 -1 1   -1 1 1   1 1 1    1 -1 1 }
shape left    quad { material white; points -1 -1 1   -1 -1 -1 -1 1 -1  -1 1 1 }
shape right   quad { material diffuse { reflectance rgb 0.1 0.6 0.1 }; points 1 -1 -1  1 -1 1  1 1 1  1 1 -1 }
shape wall    quad { material white; points 0 -1 1    0 -1 -0.9  0 1 -0.9  0 1 1 }
light lamp quad { points -0.8 0.9 0.7  -0.8 0.9 -0.3  -0.3 0.9 -0.3  -0.3 0.9 0.7; radiance 5 }
)";

// What is added to two rooms, guided against not. Returns in how many regions directions are.
std::size_t checkGuided(const std::string& added, Technique::LightPaths lightPaths, double resolution,
                        std::uint32_t samples) {
    INFO(added);
    const auto scene = TestScene::parse(kTwoRooms + added);
    RenderSettings settings = scene.settings();
    settings.samples = nightly() ? 8 * samples : samples / 2;
    settings.technique.lightPaths = Technique::LightPaths::off;
    settings.technique.guiding = Technique::Guiding::off;
    const TestImage plain = render(scene, settings);
    settings.technique.lightPaths = lightPaths;
    settings.technique.guiding = Technique::Guiding::always;
    settings.pilot = 3 * RenderSettings::kGuidePilot + (lightPaths == Technique::LightPaths::off ? 0 : 1);
    settings.seed = 2;
    const TestImage guided = render(scene, settings);
    const auto& findings = guided.statistics.caustics.of<GuideFindings>();
    CHECK(findings.verdict == GuideFindings::Verdict::used);
    CHECK(findings.distances == scene.scene().effects.has(Effect::media));
    for (const Channel channel : {Channel::y, Channel::x, Channel::z})
        checkSame(compareImages(guided.film, plain.film, channel), (nightly() ? 0.4 : 1.5) * resolution);
    CHECK(guided.statistics.dropped == std::array<std::uint64_t, 3>{});
    return findings.guided;
}

TEST_CASE("guided paths show what paths show that are not") {
    for (const std::string ball :
         {"material white", "material openpbr { base-color rgb 0.8 0.3 0.2; specular-roughness 0.3 }",
          "material dielectric { ior 1.5 }"})
        CHECK(checkGuided(fmt::format("shape sphere {{ center 0.6 -0.6 -0.3; radius 0.4; {} }}\n", ball),
                          Technique::LightPaths::off, 0.012, 256) > 0);
}

TEST_CASE("guided paths in fog, of phase functions that are even and that are not") {
    for (const char* phase : {"henyey-greenstein 0.7", "henyey-greenstein 0", "rayleigh"}) {
        CHECK(checkGuided(
                  fmt::format("shape fog box {{ min -0.99 -0.99 -0.99; max 0.99 0.99 0.99; material boundary; interior "
                              "homogeneous {{ extinction 0.8 per-m; albedo 0.9; phase {} }} }}\n",
                              std::string(phase)),
                  Technique::LightPaths::off, 0.02, 512) > 0);
        if (!nightly()) break;
    }
}

// What distances are drawn by: voids, collisions that differ by wavelength, and light of the media themselves.
TEST_CASE("guided paths in clouds, of one extinction for each wavelength, and in those that shine") {
    CHECK(
        checkGuided(
            "volume noise { size 1.9 1.9 1.9; scale 0.5; coverage 0.6; albedo 0.9; extinction table 400 1 700 3 per-m; "
            "phase henyey-greenstein 0.5 }\n",
            Technique::LightPaths::off, 0.02, 256) > 0);
    if (nightly()) // lit from all over: no directions to guide
        checkGuided(
            "shape fog box { min -0.99 -0.99 -0.99; max 0.99 0.99 0.99; material boundary; interior homogeneous "
            "{ extinction 0.8 per-m; albedo 0.9; emission 0.3 } }\n",
            Technique::LightPaths::off, 0.02, 256);
}

TEST_CASE("guided paths beside light paths") {
    const std::string ball = "shape sphere { center -0.55 -0.5 -0.3; radius 0.3; material dielectric { ior 1.5 } }\n";
    CHECK(checkGuided(ball, Technique::LightPaths::always, 0.02, 512) > 0);
    CHECK(checkGuided(ball +
                          "volume noise { size 1.9 1.9 1.9; scale 0.5; coverage 0.6; albedo 0.9; extinction 2 per-m; "
                          "phase henyey-greenstein 0.5 }\n",
                      Technique::LightPaths::always, 0.02, 256) > 0);
}

TEST_CASE("strategies: lights with textures") {
    const std::string ball = "shape sphere { center 0.3 -0.6 0; radius 0.4; material conductor { index metal Au; "
                             "roughness 0.5 } }\n";
    checkStrategies({"screen",
                     kOpenBox + ball +
                         "light quad { points -0.8 0.9 0.7  -0.8 0.9 -0.8  0.8 0.9 -0.8  0.8 0.9 0.7; radiance 4; "
                         "texture checker { even rgb 1 0.3 0.1; odd ramp { over v; stop 0.3 0; stop 1 rgb 0.2 0.3 1 }; "
                         "scale 3 } }\n",
                     512});
    checkStrategies({"ball and mesh",
                     kOpenBox + ball +
                         "shape sphere { center -0.5 0.1 0.2; radius 0.25; emission checker { even 1; odd rgb 0.1 0.4 "
                         "0.1; scale 5 } }\n"
                         "light mesh { points { - 0.2 0.9 0.5; - 0.2 0.9 -0.5; - 0.8 0.9 -0.5; - 0.8 0.7 0.5 }; "
                         "faces { - 0 1 2; - 0 2 3 }; radiance 4; texture ramp { over z; stop -0.4 0; stop 0.4 1 } }\n",
                     512, 0, 0.004});
}

TEST_CASE("strategies: rough metals") {
    checkStrategies({"metals",
                     kOpenBox + kLight +
                         "shape sphere { center -0.45 -0.5 0; radius 0.45;"
                         " material conductor { index metal Au; roughness 0.6 } }\n"
                         "shape sphere { center 0.5 -0.5 0.1; radius 0.45;"
                         " material conductor { index metal Cu; roughness 0.5; anisotropy 0.7 } }\n",
                     512});
}

TEST_CASE("strategies: rough glass, plain, dispersive and absorbing") {
    // Dispersion has rare bright paths (docs/testing.md, "Known faults"): these seeds have none of the brightest.
    for (const char* glass : {"ior 1.5; roughness 0.7", "ior glass SF11; roughness 0.7",
                              "ior glass SF11; roughness 0.7; absorption table 400 6  600 0.5  700 2"})
        checkStrategies(
            {glass,
             kOpenBox + kLight +
                 fmt::format("shape sphere {{ center 0 -0.3 0; radius 0.6; material dielectric {{ {} }} }}\n", glass),
             1536, 0, 0.004, 11});
}

TEST_CASE("strategies: a matte thing inside rough absorbing glass, with the light inside too") {
    // Next-event estimation through an interface: the segment to the light runs in the other medium.
    const std::string block = "shape sphere { center 0 -0.2 0; radius 0.75;"
                              " material dielectric { ior 1.5; roughness 0.8; absorption 1.2 } }\n";
    checkStrategies(
        {"inside", kOpenBox + block + "light sphere { center 0 -0.2 0; radius 0.3; radiance 6 }\n", 512, 0, 0.004});
    checkStrategies({"outside", kOpenBox + kLight + block, 512, 0, 0.004});
}

TEST_CASE("strategies: many lights of different kinds and powers") {
    std::string lights;
    for (int i = 0; i < 12; ++i)
        lights += fmt::format("light sphere {{ center {} {} {}; radius 0.12; radiance {} }}\n", -0.8 + 0.55 * (i % 4),
                              0.7 - 0.5 * (i / 4), -0.6 + 0.3 * (i % 3), i % 5 == 0 ? 20 : 1);
    lights += "light disk { center 0 0.95 0; normal 0 -1 0.3; radius 0.3; radiance 3 }\n"
              "light sky { radiance 0.3 }\nlight sun { elevation 20 deg; azimuth 160 deg; angular-diameter 30 deg;"
              " radiance 2 }\n";
    checkStrategies({"many lights", kOpenBox + lights, 768, 0, 0.004});
}

TEST_CASE("strategies: environment image") {
    // A dim gradient with one bright coloured patch, so that compensation takes most directions out of the sampler. The
    // eye looks down: what it sees of the image itself is the same with any strategy and would only dilute the test.
    const auto path = std::filesystem::temp_directory_path() / "abbe_strategy_environment.exr";
    writeEnvironment(path.string(), 32, 16, [](int x, int y) -> std::array<float, 3> {
        if (x >= 5 && x < 11 && y >= 3 && y < 7) return {9, 7, 2};
        return {0.2f + 0.02f * static_cast<float>(y), 0.3f, 0.5f - 0.01f * static_cast<float>(x)};
    });
    const std::string text = fmt::format("camera {{ from 0 3 4; look-at 0 0.3 0; fov 32 deg }}\n"
                                         "light environment \"{}\"\n"
                                         "shape plane {{ material diffuse {{ reflectance 0.6 }} }}\n"
                                         "shape sphere {{ center -0.6 0.5 0; radius 0.5; material conductor {{ index "
                                         "metal Al; roughness 0.6 }} }}\n"
                                         "shape sphere {{ center 0.6 0.5 0; radius 0.5; material diffuse }}\n",
                                         path.string());
    checkStrategies({"environment", text, 1024});
    std::filesystem::remove(path);
}

} // namespace abbe::test
