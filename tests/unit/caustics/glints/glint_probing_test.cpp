// Which glints the pilot finds.
#include "support/caustics_of.h"

#include <doctest/doctest.h>

namespace abbe::test {

// A ball before a mirror. The lamp is seen in the ball; in the mirror in the ball; and in the ball in the mirror in the
// ball, which is 0.02 pixels wide, while the slope from which Newton's method goes there changes its sign within 0.2.
TEST_CASE("glints: the lamp in a ball in a mirror in that ball") {
    const TestScene scene =
        TestScene::parse("scene 1 length=cm\nfilm { size 240 180 }\nrender { max-depth 3 }\n"
                         "camera { from 4 23 44; look-at 1 5 -5; lens 48 mm }\n"
                         "shape plane { material diffuse { reflectance 0.75 } }\n"
                         "shape sphere { center -4 3.5 -2; radius 3.5; material conductor { index metal Ag } }\n"
                         "shape quad { size 36 22; material conductor { index metal Ag }\n"
                         "    transform { translate 0 11 0; rotate x -6 deg; rotate y -8 deg; translate 0 0 -15 } }\n"
                         "light sphere { center -48 42 -12; radius 0.4; power 900 lm }\n");
    REQUIRE(scene.report() == "");
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
        RenderSettings settings = scene.settings();
        settings.seed = seed;
        CAPTURE(seed);
        CHECK(causticsOf(scene, settings).of<GlintFindings>().found == 3);
    }
}

} // namespace abbe::test
