// Probed glints against closed forms, sharp enough to see a fault of one per cent: the image of a sun in one level face
// of glass, and in two.
#include "caustics/glints/glint_plan.h"
#include "spectrum/named_spectra.h"
#include "spectrum/sensor.h"
#include "support/scene_test.h"
#include "support/scene_test_compare.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

// What lx count of a flat spectrum of 1 per nm.
constexpr double kGlintLuminousScale = kLuminousEfficacy * kYIntegral;
constexpr double kGlintIndex = 1.5, kRadius = 0.25 * kPiD / 180; // of the sun
constexpr int kGlintReplicates = 16;

double fresnel(double cosine) {
    const double beyond = std::sqrt(1 - (1 - square(cosine)) / square(kGlintIndex));
    const double s = (cosine - kGlintIndex * beyond) / (cosine + kGlintIndex * beyond);
    const double p = (kGlintIndex * cosine - beyond) / (kGlintIndex * cosine + beyond);
    return (square(s) + square(p)) / 2;
}

// The sun is seen in the middle of 11 × 11 pixels, whose field is 20 degrees wide, in the direction `down` below the
// horizon; `reflected`: share of its light. Nothing else is bright.
void compare(const std::string& name, double down, const std::string& glass, const std::string& sun, double reflected,
             std::uint32_t depth) {
    const TestScene scene =
        TestScene::parse(fmt::format("scene 1\nfilm {{ filter box 0.5; size 11 11 }}\nrender {{ max-depth {} }}\n"
                                     "camera {{ from 0 1 0; look-at {} {} 0; fov 20 deg }}\n"
                                     "light sun {{ toward {}; irradiance {} lx; color 1; angular-diameter 0.5 deg }}\n",
                                     depth, std::cos(down), 1 - std::sin(down), sun, kGlintLuminousScale) +
                         glass);
    RenderSettings settings = scene.settings();
    settings.samples = 2048 * kGlintReplicates;
    settings.technique.lightPaths = Technique::LightPaths::always; // level faces focus nothing
    const TestImage image = renderAsProgram(scene, settings, kGlintReplicates);
    // Its radiance times the share of the pixel that it covers.
    const double radiance = 1 / (kPiD * square(std::sin(kRadius)));
    const double share = kPiD * square(std::tan(kRadius)) / square(2 * std::tan(10 * kPiD / 180) / 11);
    const ImageComparison c =
        compareExpected(image.film, [&](int x, int y) { return x == 5 && y == 5 ? radiance * share * reflected : 0; });
    MESSAGE(fmt::format("{}: {:+.3f} ± {:.3f} %", name, 100 * c.difference, 100 * c.error));
    INFO(c.text());
    CHECK(c.wholeP > 1e-3);
    CHECK(c.error < 0.002);
    CHECK(image.statistics.caustics.of<GlintFindings>().found > 0);
}

} // namespace

TEST_CASE("glints: the sun in a level face of glass") {
    for (const double down : {30 * kPiD / 180, 60 * kPiD / 180})
        compare(
            fmt::format("{:.0f} degrees", down * 180 / kPiD), down,
            fmt::format("shape quad {{ points -9 0 9  9 0 9  9 0 -9  -9 0 -9; material dielectric {{ ior {} }} }}\n",
                        kGlintIndex),
            fmt::format("{} {} 0", -std::cos(down), -std::sin(down)), fresnel(std::sin(down)), 1);
}

TEST_CASE("glints: the sun in two faces of glass, one after the other") {
    // From a level face on to an upright one, which sends it back to where the eye is.
    const double down = 35 * kPiD / 180;
    compare("corner", down,
            fmt::format("shape quad {{ points -9 0 9  9 0 9  9 0 -9  -9 0 -9; material dielectric {{ ior {0} }} }}\n"
                        "shape quad {{ points 3 0 -9  3 0 9  3 9 9  3 9 -9; material dielectric {{ ior {0} }} }}\n",
                        kGlintIndex),
            fmt::format("{} {} 0", std::cos(down), -std::sin(down)), fresnel(std::sin(down)) * fresnel(std::cos(down)),
            2);
}

} // namespace abbe::test
