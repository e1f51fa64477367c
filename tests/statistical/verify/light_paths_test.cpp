// As a user has them: paths from the camera alone, paths from the lights beside them, and paths from the lights for all
// that they can bring come to one picture. Lights are large enough for camera paths to meet them by glass and metal.
#include "support/agreement_text.h"
#include "support/summed_picture.h"

#include <cmath>
#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

using Ways = Technique::LightPaths;
constexpr int kLightPathReplicates = 32;

using Picture = SummedPicture;

// `samples`: of each replicate.
Picture renderWays(const TestScene& test, Ways ways, std::uint32_t samples, std::uint64_t seed = 3) {
    RenderSettings settings = test.settings();
    settings.samples = samples * kLightPathReplicates;
    settings.technique.lightPaths = ways;
    settings.seed = seed + static_cast<std::uint64_t>(ways);
    return renderSummed(test, settings, kLightPathReplicates);
}

// `error`: what the standard error of the whole picture's difference must be less than, and `unjudged` the share of
// tiles that are too noisy to be judged, so that the test means something.
void agree(const std::string& name, const Picture& expected, const Picture& found, double error,
           double unjudged = 0.34) {
    const Agreement a = compare(expected.sums, found.sums, 1e-3);
    const std::string text = agreementText(name, a) + fmt::format("; {:.3g} light paths for a camera path",
                                                                  static_cast<double>(found.statistics.lightPaths) /
                                                                      static_cast<double>(found.statistics.paths));
    MESSAGE(text);
    INFO(text << worstBlocksText(a));
    CHECK(a.agrees());
    CHECK(a.whole.judged);
    CHECK(a.whole.error < error);
    CHECK(a.unjudged <= unjudged * a.tiles);
    CHECK(found.statistics.splats > 0);
    CHECK(found.statistics.cappedPaths == 0);
}

void compareWays(const std::string& name, const TestScene& test, std::uint32_t samples, double error,
                 std::uint64_t seed = 3) {
    const std::uint32_t n = nightly() ? 16 * samples : samples;
    if (nightly()) error /= 3;
    const Picture off = renderWays(test, Ways::off, 2 * n, seed), both = renderWays(test, Ways::always, n, seed),
                  alone = renderWays(test, Ways::alone, n, seed);
    CHECK(off.statistics.lightPaths == 0);
    agree(name + ", both for camera paths", off, both, error);
    // By themselves light paths find badly what shines in rough metal.
    agree(name + ", light paths for camera paths", off, alone, 4 * error, 0.5);
    agree(name + ", light paths for both", both, alone, 4 * error, 0.5);
}

TestScene lightPathScene(const std::string& text) {
    return TestScene::parse("scene 1\nfilm { size 32 24 }\nrender { max-depth 12 }\n" + text);
}

const char* const kFloor =
    "shape quad { points -5 0 5  5 0 5  5 0 -5  -5 0 -5; material diffuse { reflectance 0.5 } }\n";

} // namespace

TEST_CASE("light paths: a glass ball through a thin lens") {
    compareWays("ball",
                lightPathScene("camera { from 0 2.3 3.5; look-at 0 0.4 0; fov 34 deg; aperture 250 mm; focus 3.2 }\n" +
                               std::string(kFloor) +
                               "shape sphere { center -0.2 1.1 -0.3; radius 0.5; material dielectric { ior 1.5 } }\n"
                               "light sphere { center -1.5 5 -1; radius 0.7; radiance 10 }\n"),
                64, 0.004); // with fewer a single spark is most of the variance
}

TEST_CASE("light paths: a gold ring") {
    compareWays("ring",
                lightPathScene("camera { from 0 2.6 2.4; look-at 0 0.1 0; fov 40 deg }\n" + std::string(kFloor) +
                               "shape subdivision \"scenes/gold-ring/ring.obj\" { dicing 2\n"
                               "    material conductor { index metal Au; roughness 0.3 }; transform { scale 0.08 } }\n"
                               "light sphere { center -2 3 -3; radius 0.8; radiance 10 }\n"),
                48, 0.004, 13); // a seed with no spark that is more than half of the variance
}

TEST_CASE("light paths: a prism that disperses") {
    compareWays("prism",
                lightPathScene("camera { from 0.4 1.6 2.6; look-at 0.2 0.1 0; fov 40 deg }\n" + std::string(kFloor) +
                               "shape mesh { material dielectric { ior glass SF11 }\n"
                               "    points { - -0.5 -0.2887 -0.7; - 0.5 -0.2887 -0.7; - 0 0.5774 -0.7\n"
                               "             - -0.5 -0.2887 0.7; - 0.5 -0.2887 0.7; - 0 0.5774 0.7 }\n"
                               "    faces { - 0 2 1; - 3 4 5; - 0 1 4 3; - 1 2 5 4; - 2 0 3 5 }\n"
                               "    transform { rotate z -3.17 deg; translate -0.5 0.6 0 } }\n"
                               "light sphere { center -4 1.2 0; radius 0.8; radiance 10 }\n"),
                64, 0.012);
}

TEST_CASE("light paths: wavelengths by themselves bring what they bring together") {
    // Below a ball of constant index and one that hardly disperses: there wavelengths part, and yet go the same way to
    // within a thousandth. All that is seen is their caustic, so that an error of a hundredth shows.
    const auto caustic = [](const char* index) {
        return TestScene::parse(
            "scene 1\nfilm { size 32 24 }\nrender { max-depth 3 }\n"
            "camera { from 0.6 0.9 1.2; look-at 0.2 0 0; fov 14 deg }\n" +
            std::string(kFloor) + "light point { position -1 4 0; power 100 W }\n" +
            fmt::format("shape sphere {{ center 0 0.55 0; radius 0.35; material dielectric {{ ior {} }} }}\n", index));
    };
    const std::uint32_t samples = nightly() ? 64 : 16;
    const Picture together = renderWays(caustic("1.5"), Ways::alone, samples),
                  apart = renderWays(caustic("cauchy 1.5 1e-4"), Ways::alone, samples, 103);
    const Agreement a = compare(together.sums, apart.sums, 1e-3);
    MESSAGE(agreementText("a ball that hardly disperses", a));
    // Rare bright paths make one replicate most of the variance, so that its Student's t says nothing. Five pairs of
    // seeds differed by 0.06 to 0.19 %.
    CHECK(std::abs(a.whole.difference) < 0.005);
    CHECK(a.whole.error < 0.004);
    CHECK(apart.statistics.splats > 0);
}

TEST_CASE("light paths: a glass ball in fog") {
    compareWays(
        "fog",
        lightPathScene("camera { from 0 1 4; look-at 0 0.8 0; fov 34 deg }\n" + std::string(kFloor) +
                       "light sphere { center -1 3.4 0.6; radius 0.5; radiance 20 }\n"
                       "shape sphere { center -0.1 1.1 0; radius 0.35; material dielectric { ior 1.5; priority 2 } }\n"
                       "shape box { min -1.2 0.1 -1.2; max 1.2 2 1.2; material boundary\n"
                       "    interior homogeneous { extinction table 400 0.7 700 0.4 per-m; albedo 0.95; phase "
                       "henyey-greenstein 0.4 } }\n"),
        32, 0.004);
}

// Most of what is seen the medium scatters before anything else; the wall is lit through the prism, too, and its hero
// alone may have come that way.
TEST_CASE("light paths: a light in the haze behind a prism" * doctest::skip(!nightly())) {
    compareWays("haze",
                lightPathScene("camera { from 0.4 1.2 3; look-at 0 0.7 0; fov 40 deg }\n" + std::string(kFloor) +
                               "light spot { position -1.9 1 0.2; look-at 1 0.7 0; angle 50 deg; inner-angle 30 deg; "
                               "intensity 100 cd }\n"
                               "light sphere { center -0.3 1.7 -0.6; radius 0.2; radiance 8 }\n"
                               "shape mesh { material dielectric { ior glass SF11; priority 2 }\n"
                               "    points { - -0.4 0.4 -0.5; - 0.4 0.4 -0.5; - 0 1.0928 -0.5\n"
                               "             - -0.4 0.4 0.5; - 0.4 0.4 0.5; - 0 1.0928 0.5 }\n"
                               "    faces { - 0 2 1; - 3 4 5; - 0 1 4 3; - 1 2 5 4; - 2 0 3 5 } }\n"
                               "shape quad { points 1.3 0 -1.2  1.3 0 1.2  1.3 2 1.2  1.3 2 -1.2; material diffuse }\n"
                               "shape box { min -1.2 0.1 -1.2; max 1.2 2 1.2; material boundary\n"
                               "    interior homogeneous { extinction table 400 0.7 700 0.4 per-m; albedo 0.95; phase "
                               "henyey-greenstein 0.4 } }\n"),
                64, 0.006);
}

TEST_CASE("light paths: rough glass and rough metal all around the camera") {
    compareWays(
        "rough",
        lightPathScene(
            "camera spherical { from 0 0.8 0; look-at 0 0.3 -1; width 240 deg; height 120 deg }\n" +
            std::string(kFloor) +
            "shape sphere { center -0.9 0.9 -0.9; radius 0.45; material dielectric { ior 1.5; roughness 0.3 } }\n"
            "shape sphere { center 0.9 0.5 -0.9; radius 0.4; material conductor { index metal Au; roughness 0.3 } }\n"
            "shape sphere { center 0.9 0.4 0.9; radius 0.35; material dielectric { ior glass SF11; roughness 0.3 } }\n"
            "light sphere { center -0.8 2.6 0.2; radius 0.5; radiance 10 }\n"),
        64, 0.003);
}

TEST_CASE("light paths: walls and a light that the camera does not see") {
    compareWays("hidden",
                lightPathScene(
                    "camera { from 0 1.6 4; look-at 0 0.6 0; fov 40 deg }\n" + std::string(kFloor) +
                    "light sphere { center -0.8 1.4 1.2; radius 0.45; radiance 12; visible-to shadows reflections }\n"
                    "shape sphere { center 0.5 0.5 0; radius 0.45; material dielectric { ior 1.5; roughness 0.3 } }\n"
                    "shape quad { points -1 0 1  1 0 1  1 1.5 1  -1 1.5 1; visible-to shadows reflections\n"
                    "    material diffuse { reflectance rgb 0.8 0.4 0.2 } }\n"),
                56, 0.006);
}

TEST_CASE("light paths: a wide beam on rough glass and rough metal in haze" * doctest::skip(!nightly())) {
    compareWays(
        "beam",
        lightPathScene(
            "camera { from 0 1.6 4; look-at 0 0.6 0; fov 40 deg }\n" + std::string(kFloor) +
            "light beam { position -1.5 2 0.5; look-at 0.2 0.3 0; radius 0.5; divergence 20 deg; power 40 W }\n"
            "shape sphere { center 0.5 0.5 0; radius 0.45; material dielectric { ior 1.5; roughness 0.3 } }\n"
            "shape sphere { center -0.4 0.4 0.3; radius 0.3; material conductor { index metal Au; roughness 0.3 } }\n"
            "shape box { min -1.2 0.1 -1.2; max 1.2 2 1.2; material boundary\n"
            "    interior homogeneous { extinction 0.3 per-m; albedo 0.95 } }\n"),
        112, 0.012);
}

// The lenses of the shipped scene under a light, as wide as a sun of 20 degrees.
TEST_CASE("light paths: an array of lenses") {
    std::string lenses = "object lens { shape mesh \"scenes/lens-array/lens.obj\" {\n"
                         "    material dielectric { ior glass N-BK7 }; transform { scale 0.01 } } }\n";
    for (const double x : {-0.3, 0.0, 0.3})
        for (const double z : {-0.3, 0.0, 0.3})
            lenses += fmt::format("instance lens {{ transform {{ translate {} 0.5 {} }} }}\n", x, z);
    compareWays("lenses",
                lightPathScene("camera { from 0.4 1.8 1.8; look-at 0 0.2 0; fov 40 deg }\n" + std::string(kFloor) +
                               lenses + "light sphere { center -0.8 3.5 -0.4; radius 0.6; radiance 10 }\n"),
                24, 0.03);
}

} // namespace abbe::test
