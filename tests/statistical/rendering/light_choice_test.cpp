// Many lights: the choice by the tree against the choice by power, and against scattering alone (T3.1).
#include "support/scene_test.h"
#include "support/scene_test_compare.h"
#include "support/statistics.h"

#include <algorithm>
#include <cstddef>
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <numeric>
#include <vector>

namespace abbe::test {
namespace {

constexpr const char* kLightRoom = R"(scene 1
film { size 24 24; filter box 0.5 }
camera { from 0 2 9; look-at 0 1 0; fov 40 deg }
shape floor quad { points -5 0 5  5 0 5  5 0 -5  -5 0 -5; material diffuse { reflectance 0.6 } }
shape back quad { points -5 0 -5  5 0 -5  5 4 -5  -5 4 -5; material conductor { index metal Al; roughness 0.4 } }
shape ball sphere { center -1.5 0.9 0; radius 0.9; material dielectric { ior 1.5; roughness 0.3 } }
shape block sphere { center 1.5 0.9 0; radius 0.9; material diffuse { reflectance 0.8 } }
)";

// Of all kinds and sizes, in no order. `bare`: also those that nothing but choosing them finds.
std::string randomLights(int count, bool bare, std::uint64_t seed) {
    Random random(seed);
    const auto u = [&random](double a, double b) { return a + (b - a) * static_cast<double>(random.uniform()); };
    std::string text;
    for (int i = 0; i < count; ++i) {
        const double x = u(-4.5, 4.5), y = u(0.3, 4), z = u(-4.5, 3), w = std::pow(10, u(-1.5, 0.5));
        const double s = u(0.02, 0.2), t = u(0.02, 0.2);
        switch ((bare ? 0 : 2) + static_cast<int>(random.bits() % (bare ? 4 : 2))) {
        case 0:
            text += fmt::format("light point {{ position {} {} {}; power {} W }}\n", x, y, z, w);
            break;
        case 1:
            text += fmt::format("light spot {{ position {} {} {}; toward {} {} {}; angle {} deg; power {} W }}\n", x, y,
                                z, u(-1, 1), u(-1, 1), u(-1, 1), u(20, 200), w);
            break;
        case 2:
            text += fmt::format("light sphere {{ center {} {} {}; radius {}; power {} W }}\n", x, y, z, s, w);
            break;
        default:
            text += fmt::format("light quad {{ points {} {} {}  {} {} {}  {} {} {}  {} {} {}; power {} W; {} }}\n", x,
                                y, z, x + s, y, z, x + s, y + t, z + s, x, y + t, z + s, w,
                                random.bits() % 2 ? "two-sided #true" : "");
        }
    }
    // A bent strip of triangles and quads under the ceiling.
    text += "light mesh { points { ";
    for (int i = 0; i <= 20; ++i)
        text += fmt::format("- {} {} -2; - {} {} -1.6; ", 0.3 * i - 3, 3.4 + 0.3 * (i % 3), 0.3 * i - 3,
                            3.3 + 0.3 * (i % 2));
    text += "}; faces { ";
    for (int i = 0; i < 20; ++i) {
        const int a = 2 * i;
        text += i % 2 ? fmt::format("- {} {} {} {}; ", a, a + 2, a + 3, a + 1)
                      : fmt::format("- {} {} {}; - {} {} {}; ", a, a + 2, a + 1, a + 1, a + 2, a + 3);
    }
    return text + "}; power 5 W }\n";
}

TestImage renderBy(const TestScene& scene, Technique::LightChoice choice, std::uint32_t samples, std::uint64_t seed,
                   Technique::Strategy strategy = Technique::Strategy::mis) {
    RenderSettings settings = scene.settings();
    settings.technique.lightChoice = choice;
    settings.samples = nightly() ? 8 * samples : samples;
    settings.maxDepth = 2;
    settings.seed = seed;
    settings.technique.strategy = strategy;
    return render(scene, settings);
}

// Relative variances of the pixels' means, by the replicates.
std::vector<double> spreads(const TestImage& image) {
    std::vector<double> all;
    const PixelBounds b = image.film.bounds();
    for (int y = b.y0; y < b.y1; ++y)
        for (int x = b.x0; x < b.x1; ++x) {
            const Estimate e = image.film.pixel(x, y);
            all.push_back(e.variance / square(e.mean));
        }
    std::erase_if(all, [](double v) { return !std::isfinite(v); }); // where it is dark
    return all;
}
// That of the typical pixel: the median, as those that a light all but touches have any.
double spread(const TestImage& image) {
    std::vector<double> all = spreads(image);
    std::ranges::nth_element(all, all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2));
    return all[all.size() / 2];
}

using enum Technique::LightChoice;

} // namespace

TEST_CASE("a thousand lights of all kinds: by the tree as by power, with less noise (T3.1)") {
    const auto scene = TestScene::parse(kLightRoom + randomLights(1000, true, 4));
    const TestImage byTree = renderBy(scene, tree, 128, 1), byPower = renderBy(scene, power, 512, 2);
    checkSame(compareImages(byTree.film, byPower.film), 0.04);
    const double gain = 4 * spread(byPower) / spread(byTree);
    MESSAGE("variance per sample: ", gain, " times that of the tree");
    CHECK(gain > 1.8);
}

// What the look at the frame finds of walls changes the noise, and nothing else.
TEST_CASE("lamps on both sides of a wall: chosen by what arrives as by power, with less noise") {
    std::string text = R"(scene 1
film { size 64 64; filter box 0.5 }
camera { from 0 9 0.1; look-at 0 0 0; fov 40 deg }
shape floor quad { points -3 0 3  3 0 3  3 0 -3  -3 0 -3; material diffuse { reflectance 0.6 } }
shape wall box { min -0.05 0 -3; max 0.05 3 3; material diffuse { reflectance 0.3 } }
light left sphere { center -1 1.5 0; radius 0.1; power 20 W }
light right sphere { center 1 1.5 1; radius 0.1; power 60 W }
light dim point { position 2 1 -1; power 3 W }
)";
    const auto scene = TestScene::parse(text);
    REQUIRE(scene.report() == "");
    const TestImage byTree = renderBy(scene, tree, 16, 1), byPower = renderBy(scene, power, 64, 2);
    checkSame(compareImages(byTree.film, byPower.film), 0.03);
    // The mean of all but the brightest tenth: places that a lamp all but touches have any.
    const auto typical = [](const TestImage& image) {
        std::vector<double> all = spreads(image);
        std::ranges::sort(all);
        all.resize(all.size() * 9 / 10);
        return std::accumulate(all.begin(), all.end(), 0.0);
    };
    const double gain = 4 * typical(byPower) / typical(byTree);
    MESSAGE("variance per sample: ", gain, " times that of the tree");
    CHECK(gain > 2); // 4.4 by day; 1.2 without what the look finds
}

// Without places that a light all but touches, where an even choice would converge too slowly to say anything: the
// means are compared to a fifth of a per cent.
TEST_CASE("a thousand lights over a floor: by the tree as by an even choice (T3.1)") {
    Random random(9);
    const auto u = [&random](double a, double b) { return a + (b - a) * static_cast<double>(random.uniform()); };
    std::string text = R"(scene 1
film { size 24 24; filter box 0.5 }
camera { from 0 1.9 7; look-at 0 0 0; fov 24 deg }
shape floor quad { points -6 0 6  6 0 6  6 0 -6  -6 0 -6; material diffuse { reflectance 0.6 } }
shape ball sphere { center -0.8 0.5 0; radius 0.5; material diffuse { reflectance 0.8 } }
shape shiny sphere { center 0.8 0.4 0.5; radius 0.4; material conductor { index metal Al; roughness 0.5 } }
)";
    for (int i = 0; i < 1000; ++i) {
        const double x = u(-5, 5), y = u(2.3, 4.5), z = u(-5, 5), w = std::pow(10, u(-0.5, 0.5)), s = u(0.02, 0.1);
        const auto place = fmt::format("{} {} {}", x, y, z);
        if (i % 4 == 0)
            text += fmt::format("light point {{ position {}; power {} W }}\n", place, w);
        else if (i % 4 == 1)
            text += fmt::format("light spot {{ position {}; toward {} 0 {}; angle {} deg; power {} W }}\n", place,
                                u(-3, 3), u(-3, 3), u(60, 170), w);
        else if (i % 4 == 2)
            text += fmt::format("light sphere {{ center {}; radius {}; power {} W }}\n", place, s, w);
        else
            text += fmt::format("light quad {{ points {}  {} {} {}  {} {} {}  {} {} {}; power {} W }}\n", place, x + s,
                                y, z, x + s, y + s / 3, z + s, x, y + s / 3, z + s, w);
    }
    const auto scene = TestScene::parse(text);
    const TestImage byTree = renderBy(scene, tree, 2048, 1), evenly = renderBy(scene, uniform, 16384, 2);
    checkSame(compareImages(byTree.film, evenly.film), 0.002);
}

TEST_CASE("emitters, a sun and a sky: the tree's choice against scattering alone") {
    const auto scene =
        TestScene::parse(kLightRoom + randomLights(40, false, 5) +
                         "light sun { elevation 40 deg; angular-diameter 20 deg; irradiance 0.2 W-per-m2 "
                         "}\nlight sky { luminance 3 nits }\n");
    using enum Technique::Strategy;
    const TestImage both = renderBy(scene, tree, 256, 1), lights = renderBy(scene, tree, 256, 2, lightsOnly);
    const TestImage bsdf = renderBy(scene, tree, 1024, 3, bsdfOnly);
    checkSame(compareImages(both.film, lights.film), 0.05);
    checkSame(compareImages(both.film, bsdf.film), 0.05);
}

// Lights that are seen in the surfaces alone, and so large that scattering finds them about as often as the choice
// does: hits must be weighed with the same choice as samples, whatever the lobes make of it.
TEST_CASE("shiny surfaces: the tree's choice by lobes against scattering alone and by power") {
    Random random(8);
    const auto u = [&random](double a, double b) { return a + (b - a) * static_cast<double>(random.uniform()); };
    std::string text = R"(scene 1
film { size 24 24; filter box 0.5 }
camera { from 0 2 9; look-at 0 1 0; fov 40 deg }
shape floor quad { points -5 0 5  5 0 5  5 0 -5  -5 0 -5
  material layered { roughness 0.3; base diffuse { reflectance 0.1 } } }
shape back quad { points -5 0 -5  5 0 -5  5 5 -5  -5 5 -5; material conductor { index metal Cu; roughness 0.3 } }
shape ball sphere { center -1.5 0.9 0; radius 0.9; material dielectric { ior 1.5; roughness 0.3 } }
shape block sphere { center 1.5 0.9 0; radius 0.9; material openpbr { base-color 0.1; specular-roughness 0.3 } }
)";
    for (int i = 0; i < 60; ++i)
        text += fmt::format("light sphere {{ center {} {} {}; radius {}; power {} W }}\n", u(-5, 5),
                            i % 2 ? u(5, 7) : u(0.5, 4), i % 2 ? u(-4, 4) : u(9.5, 12), u(0.1, 0.3),
                            std::pow(10, u(-0.5, 0.5)));
    const auto scene = TestScene::parse(text);
    REQUIRE_MESSAGE(!scene.diagnostics().hasErrors(), scene.report());
    using enum Technique::Strategy;
    const TestImage both = renderBy(scene, tree, 256, 1), lights = renderBy(scene, tree, 512, 2, lightsOnly);
    const TestImage bsdf = renderBy(scene, tree, 1024, 3, bsdfOnly), byPower = renderBy(scene, power, 512, 4);
    checkSame(compareImages(both.film, lights.film), 0.03);
    checkSame(compareImages(both.film, bsdf.film), 0.03);
    checkSame(compareImages(both.film, byPower.film), 0.03);
    const double gain = 2 * spread(byPower) / spread(both);
    MESSAGE("variance per sample: ", gain, " times that of the tree");
    CHECK(gain > 4);
}

TEST_CASE("lights in fog: the choice along the ray and the choice where it scatters make one picture") {
    const auto scene = TestScene::parse(kLightRoom + randomLights(12, true, 6) +
                                        "volume air atmosphere { extinction 0.05 per-m; albedo 1 }\n");
    const TestImage byTree = renderBy(scene, tree, 256, 1), byPower = renderBy(scene, power, 512, 2);
    checkSame(compareImages(byTree.film, byPower.film), 0.07);
}

TEST_CASE("moving lights are chosen wherever they are") {
    const auto scene = TestScene::parse(
        std::string(kLightRoom).replace(std::string(kLightRoom).find("from 0 2 9"), 0, "shutter 1 s; ") +
        "light quad { points -0.3 0 0.3  -0.3 0 -0.3  0.3 0 -0.3  0.3 0 0.3; power 10 W\n"
        "  transform { at 0 s { translate -3 1.5 1 }; at 1 s { rotate z 100 deg; translate 3 3 -2 } } }\n"
        "light sphere { center 0 3 0; radius 0.1; power 3 W }\nlight spot { position 0 3 2; toward 0 -1 0; power 3 W\n"
        "  transform { at 0 s { translate -2 0 0 }; at 1 s { translate 2 0 0 } } }\n");
    const TestImage byTree = renderBy(scene, tree, 1024, 1), byPower = renderBy(scene, power, 1024, 2);
    checkSame(compareImages(byTree.film, byPower.film), 0.02);
}

// docs/hard_cases.md, case 35.
TEST_CASE("dark lights are told of, left out, and do no harm") {
    const auto scene =
        TestScene::parse(std::string(kLightRoom) + "light point { position 0 3 0; power 0 W }\n"
                                                   "light sphere { center 0 3 0; radius 0.2; luminance 0 nits }\n"
                                                   "light point { position 0 3 2; power 3 W }\n");
    CHECK(scene.report().find("W0740") != std::string::npos);
    const auto alone = TestScene::parse(
        std::string(kLightRoom) + "shape sphere { center 0 3 0; radius 0.2; material diffuse { reflectance 0 } }\n"
                                  "light point { position 0 3 2; power 3 W }\n");
    const TestImage a = renderBy(scene, tree, 64, 1), b = renderBy(alone, tree, 64, 1);
    checkSame(compareImages(a.film, b.film), 0.02);
}

} // namespace abbe::test
