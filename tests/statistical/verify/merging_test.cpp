// Caustics behind mirrors and glass by merging and by camera paths alone, in scenes in which camera paths do find the
// light. Merging blurs: what is lit evenly shows no blur, and the rest is to be as wrong as the two radii say.
#include "caustics/manifold/manifold_plan.h"
#include "support/agreement_text.h"
#include "support/summed_picture.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

constexpr int kMergingReplicates = 16;

using Picture = SummedPicture;

// `samples`: of each replicate.
Picture renderMerged(const TestScene& test, bool merging, std::uint32_t samples,
                     Technique::LightPaths lightPaths = Technique::LightPaths::automatic) {
    RenderSettings settings = test.settings();
    settings.samples = (nightly() ? 16 : 1) * samples * kMergingReplicates;
    settings.technique.lightPaths = merging ? lightPaths : Technique::LightPaths::off;
    settings.technique.merging = merging ? Technique::Merging::always : Technique::Merging::off;
    settings.seed = merging ? 5 : 7;
    return renderSummed(test, settings, kMergingReplicates);
}

// `error`: what the standard error of the whole picture's difference must be less than.
void mergedAgree(const std::string& name, const Picture& expected, const Picture& found, double error) {
    const Agreement a = compare(expected.sums, found.sums, 2e-3);
    const std::string text = agreementText(name, a) +
                             fmt::format("; {} rounds, {} splats", found.statistics.rounds, found.statistics.splats);
    MESSAGE(text);
    INFO(text << worstBlocksText(a));
    CHECK(a.agrees());
    CHECK(a.whole.judged);
    CHECK(a.whole.error < error);
    CHECK(3 * a.unjudged <= a.tiles);
    CHECK(found.statistics.rounds > 0);
    CHECK(found.statistics.cappedPaths == 0);
}

// A floor behind a mirror, and nothing of the light: most of the picture is what can be merged.
TestScene inlineScene(const std::string& text) {
    return TestScene::parse(
        "scene 1\nfilm { size 48 36 }\nrender { max-depth 16 }\n"
        "camera { from 0 3 1; look-at 0 0.5 -2.5; fov 22 deg }\n"
        "shape quad { points -3 0 3  3 0 3  3 0 -3  -3 0 -3; material diffuse { reflectance 0.5 } }\n"
        "shape quad { points -3 0 -2.5  3 0 -2.5  3 3 -2.5  -3 3 -2.5; material conductor { index "
        "metal Ag } }\n" +
        text);
}

// A light in balls within balls: all of its light comes over four faces.
std::string shells(const std::string& outer) {
    return "shape sphere { center 0 0.9 0; radius 0.7; material dielectric { " + outer +
           "; priority 1 } }\n"
           "shape sphere { center 0 0.95 0; radius 0.55; material dielectric { ior 1.5; priority 2 } }\n"
           "shape sphere { center 0 0.9 0; radius 0.4; material dielectric { ior 1.25; priority 3 } }\n"
           "shape sphere { center 0.02 0.9 0; radius 0.3; material dielectric { ior 1.6; priority 4 } }\n"
           "light sphere { center 0.02 0.9 0; radius 0.22; radiance 10 }\n";
}

const char* const kBallUnderLight = "shape sphere { center 0 0.9 -1; radius 0.5; material dielectric { ior 1.5 } }\n"
                                    "light sphere { center 0.2 3.4 -0.6; radius 0.7; radiance 10 }\n";

} // namespace

TEST_CASE("merging: a light within four balls of glass, in a mirror") {
    const TestScene scene = inlineScene(shells("ior 1.3"));
    mergedAgree("shells", renderMerged(scene, false, 128), renderMerged(scene, true, 32), 0.02);
}

// With fewer samples a spark is all of the error.
TEST_CASE("merging: glass that disperses") {
    const TestScene scene = inlineScene(shells("ior glass SF11"));
    mergedAgree("SF11", renderMerged(scene, false, 256), renderMerged(scene, true, 64), 0.03);
}

TEST_CASE("merging: beside manifold sampling, which has some of the light") {
    const TestScene scene = inlineScene(kBallUnderLight);
    const Picture found = renderMerged(scene, true, 32, Technique::LightPaths::always);
    CHECK(found.statistics.caustics.of<ManifoldFindings>().used);
    mergedAgree("ball", renderMerged(scene, false, 128), found, 0.02);
}

TEST_CASE("merging: fog and absorbing glass" * doctest::skip(!nightly())) {
    const TestScene scene = inlineScene(
        "shape sphere { center 0 0.9 -1; radius 0.5; material dielectric { ior 1.5; absorption table 400 0.5 700 0.1 "
        "per-m } }\n"
        "shape box { min -1.5 0.1 -2; max 1.5 2 0; material boundary\n"
        "    interior homogeneous { extinction table 400 0.3 700 0.2 per-m; albedo 0.9 } }\n"
        "light sphere { center 0.2 3.4 -0.6; radius 0.7; radiance 10 }\n");
    mergedAgree("fog", renderMerged(scene, false, 128), renderMerged(scene, true, 64), 0.02);
}

// Nothing but haze shows the light's light, which comes over four faces.
TEST_CASE("merging: in haze, in a mirror") {
    const TestScene scene = TestScene::parse(
        "scene 1\nfilm { size 48 36 }\nrender { max-depth 16 }\n"
        "camera { from 0 2 1; look-at 0 0.9 -2.5; fov 26 deg }\n"
        "shape quad { points -3 0 -2.5  3 0 -2.5  3 3 -2.5  -3 3 -2.5; material conductor { index metal Ag } }\n" +
        shells("ior 1.3") +
        "shape box { min -2 -0.5 -1.5; max 2 2.5 2; material boundary\n"
        "    interior homogeneous { extinction table 400 0.5 700 0.3 per-m; albedo 0.9; phase henyey-greenstein 0.5 } "
        "}\n");
    mergedAgree("haze", renderMerged(scene, false, 64), renderMerged(scene, true, 16), 0.02);
}

} // namespace abbe::test
