// Small images of lights in mirrors and glass, probed and by camera paths alone, of lights that these do find.
#include "caustics/glints/glint_plan.h"
#include "support/agreement_text.h"
#include "support/summed_picture.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

constexpr int kReplicates = 16;

// `samples`: of each replicate.
SummedPicture renderProbed(const TestScene& test, bool probed, std::uint32_t samples) {
    RenderSettings settings = test.settings();
    settings.samples = (nightly() ? 8 : 1) * samples * kReplicates;
    settings.technique.lightPaths = probed ? Technique::LightPaths::automatic : Technique::LightPaths::off;
    settings.technique.merging = Technique::Merging::off;
    settings.seed = probed ? 25 : 27;
    return renderSummed(test, settings, kReplicates);
}

// `error`: what the standard error of the whole picture's difference must be less than.
void agree(const std::string& name, const TestScene& scene, double error) {
    const SummedPicture expected = renderProbed(scene, false, 512), found = renderProbed(scene, true, 64);
    const Agreement a = compare(expected.sums, found.sums, 2e-3);
    const auto& glints = found.statistics.caustics.of<GlintFindings>();
    MESSAGE(agreementText(name, a) << fmt::format("; {} glints, {:.3g} rays", glints.found, glints.rays));
    INFO(worstBlocksText(a));
    CHECK(a.agrees());
    CHECK(a.whole.judged);
    CHECK(a.whole.error < error);
    CHECK(2 * a.unjudged <= a.tiles);
    CHECK(glints.found > 0);
}

// A ball above a floor that is nearly black: most of the light is that of glints. All events of a chain are likely, and
// most filters have no tails, or camera paths would know neither the light nor what they miss.
TestScene inlineScene(const std::string& light, const std::string& material, const std::string& camera = "",
                      const std::string& film = "filter box", const std::string& floor = "0.02") {
    return TestScene::parse("scene 1\nfilm { size 48 36; " + film +
                            " }\nrender { max-depth 3 }\n"
                            "camera { from 0 0.4 6; look-at 0 0 0; fov 30 deg; " +
                            camera + " }\nshape sphere { radius 1.3; material " + material +
                            " }\n"
                            "shape plane { center 0 -1.4 0; material diffuse { reflectance " +
                            floor + " } }\n" + light);
}

const char* const kSun = "light sun { elevation 40 deg; azimuth 150 deg; irradiance 1 klx; angular-diameter 10 deg }\n";
const char* const kSunBehind =
    "light sun { elevation 35 deg; azimuth 20 deg; irradiance 1 klx; angular-diameter 10 deg }\n";
const char* const kLight = "light sphere { center 3 4 4; radius 0.4; radiance 10 }\n";
const char* const kGlass = "dielectric { ior 2.4 }";

} // namespace

TEST_CASE("glints: a sun in a ball of glass") { agree("sun", inlineScene(kSun, kGlass), 0.05); }

// Its caustic on the floor, dim and wide, is met by one camera path in millions, but by light paths.
TEST_CASE("glints: glass that disperses") {
    agree("SF11", inlineScene(kSunBehind, "dielectric { ior glass SF11 }", "", "filter box", "0"), 0.05);
}

TEST_CASE("glints: a light at a place, in silver, and a lens with an opening") {
    agree("lamp", inlineScene(kLight, "conductor { index metal Ag }", "aperture 100 mm; focus 5", ""), 0.05);
}

TEST_CASE("glints: fog on the way" * doctest::skip(!nightly())) {
    agree("fog",
          inlineScene("shape box { min -3 -1.35 -2; max 3 2 2; material boundary\n"
                      "    interior homogeneous { extinction table 400 0.1 700 0.05 per-m; albedo 0.5 } }\n" +
                          std::string(kSun),
                      kGlass),
          0.05);
}

TEST_CASE("glints: a filter with negative parts has none") {
    const TestScene scene = inlineScene(kSun, kGlass, "", "filter mitchell");
    CHECK(renderProbed(scene, true, 1).statistics.caustics.of<GlintFindings>().found == 0);
}

} // namespace abbe::test
