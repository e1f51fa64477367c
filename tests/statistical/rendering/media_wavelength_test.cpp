// Media whose extinction varies with wavelength: eight wavelengths to a path against one, by a kernel that knows
// nothing of wavelengths that differ.
#include "support/scene_test_compare.h"
#include "support/scene_test_paths.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

const std::string kMediaWavelengthHeader = "scene 1\nfilm { size 16 16; filter box 0.5 }\n"
                                           "camera { from 0 0 4; look-at 0 0 0; fov 36 deg }\n"
                                           "light sky { radiance table 400 0.05  700 0.3 }\n"
                                           "light quad { points { - 1 2 1; - 2 2 1; - 2 2 0; - 1 2 0 }; two-sided on; "
                                           "radiance table 400 12  550 4  700 8 }\n";

// `resolution`: of the image's mean; the blue of a medium that is thin to red converges more slowly.
void checkWavelengths(const std::string& text, double resolution) {
    INFO(text);
    const TestScene scene = TestScene::parse(kMediaWavelengthHeader + text);
    const TestImage hero = render(scene, nightly() ? 16384 : 1024);
    CHECK(hero.statistics.kernel == "all");
    constexpr EffectBits kGrey = (Effects(Effect::absorption) | Effect::media | Effect::interfaces).bits();
    const RecordingFilm single =
        renderPaths<kGrey>(scene, {.samples = nightly() ? 4096u : 256u, .seed = 77, .wavelengths = oneWavelength});
    for (const Channel channel : {Channel::x, Channel::y, Channel::z})
        checkSame(compareImages(hero.film, single, channel), nightly() ? resolution / 2 : resolution);
}

} // namespace

TEST_CASE("wavelengths in media: extinction 1 : 16, not white, under a light and a coloured sky") {
    checkWavelengths("shape sphere { radius 1; material boundary; interior homogeneous { extinction table 400 0.3  "
                     "700 4.8; albedo table 400 0.95  700 0.6; phase henyey-greenstein 0.5 } }\n",
                     0.005);
}

TEST_CASE("wavelengths in media: the same where blue is the denser, and over a floor in haze") {
    checkWavelengths("shape sphere { radius 1; material boundary; interior homogeneous { extinction table 400 4.8  "
                     "550 1.2  700 0.3; albedo 0.8; phase henyey-greenstein -0.4 } }\n"
                     "shape plane { center 0 -1.2 0; material diffuse }\n"
                     "volume atmosphere { extinction table 400 0.16  700 0.01; albedo 0.9; scale-height 1; "
                     "ground -1.2; phase rayleigh }\n",
                     0.005);
}

} // namespace abbe::test
