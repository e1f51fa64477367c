// Paths that surfaces take no light from are found before the first sample, and those surfaces; others that are long
// are not.
#include "render/first_look.h"
#include "render/render_state.h"
#include "support/scene_test.h"

#include <algorithm>
#include <doctest/doctest.h>

namespace abbe::test {
namespace {

struct LookedAt {
    std::vector<std::string> shapes; // in order of names
    double rays = 0, share = 0;
};

LookedAt lookAtFrame(const std::string& text) {
    const auto scene = TestScene::parse("scene 1\nfilm { size 16 16 }\n" + text);
    REQUIRE(scene.report() == "");
    RenderSettings settings = scene.settings();
    settings.samples = 1;
    LookedAt seen;
    std::atomic<bool> stop = false;
    RenderControl control{&stop, {}};
    control.firstLook = [&](const FirstLook& look) {
        for (const Shape* shape : look.endless.shapes) seen.shapes.push_back(scene.scene().names.at(shape));
        seen.rays = look.raysOfPath;
        seen.share = look.endless.share;
        stop = true; // that was all
    };
    RecordingFilm film(scene.built().film, 1);
    makePathTracer(scene.scene().effects)->render(scene.scene(), film, settings, control);
    std::ranges::sort(seen.shapes);
    return seen;
}

const std::string kFacingMirrors = R"(
camera { from 0 0 0.9; look-at 0.02 0.01 -1; fov 50 deg }
light sphere { center 0 30 0; radius 1; radiance 1 }
shape far quad { points -4e3 -4e3 -1  4e3 -4e3 -1  4e3 4e3 -1  -4e3 4e3 -1; material conductor { index { n 0; k 5 } } }
shape near quad { points -4e3 -4e3 1  -4e3 4e3 1  4e3 4e3 1  4e3 -4e3 1; material conductor { index { n 0; k 5 } } }
)";

} // namespace

TEST_CASE("mirrors that face each other and reflect everything are named") {
    const LookedAt seen = lookAtFrame(kFacingMirrors);
    CHECK(seen.shapes == std::vector<std::string>{"far", "near"});
    CHECK(seen.rays > 100);
    CHECK(seen.share > 0.5);
}

TEST_CASE("a closed box that reflects everything is named, whatever its surface") {
    for (const std::string material : {"conductor { index { n 0; k 5 } }", "diffuse { reflectance 1 }"}) {
        CAPTURE(material);
        const LookedAt seen = lookAtFrame("camera { from 0.1 0.2 0.3; look-at 1 0.4 0.2; fov 50 deg }\n"
                                          "light sphere { center 0 0.8 0; radius 0.01; radiance 1 }\n"
                                          "shape room box { size 2 2 2; transform { scale 1 1 -1 }; material " +
                                          material + " }\n");
        CHECK(seen.shapes == std::vector<std::string>{"room"});
    }
}

TEST_CASE("long paths that lose light, and clear glass, are no such paths") {
    const LookedAt white = lookAtFrame("camera { from 0.1 0.2 0.3; look-at 1 0.4 0.2; fov 50 deg }\n"
                                       "light sphere { center 0 0.8 0; radius 0.01; radiance 1 }\n"
                                       "shape box { size 2 2 2; transform { scale 1 1 -1 }; material diffuse { "
                                       "reflectance 0.99 } }\n");
    CHECK(white.rays > 50);
    CHECK(white.shapes.empty());
    const LookedAt glass = lookAtFrame("camera { from 0 0 4; look-at 0 0 0; fov 30 deg }\nlight sky { radiance 1 }\n"
                                       "shape sphere { material dielectric { ior 1.5 } }\n");
    CHECK(glass.rays < 30);
    CHECK(glass.shapes.empty());
}

} // namespace abbe::test
