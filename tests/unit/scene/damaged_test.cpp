// What a syntax error takes out of a scene is not used as if it were whole: one sign too many, in any place, is an
// error and nothing worse.
#include "support/scene_test.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test::damaged {

namespace {

// One of all that is bound by itself.
const std::string kScene = R"(scene 1
param size 0.5 "of the ball"
camera main { from 0 1 4; look-at 0 0 0; fov 40 deg; f-stop 8; focus 4 }
film { size 8 8; filter box 0.5; layers { depth; light-group key lamp } }
render { samples 4 }
texture spots checker { even rgb 0.1 0.2 0.3; odd 0.7; scale 3 }
material gold conductor { index metal Au; roughness 0.2 }
material other conductor { index { n 0.2; k table 400 3  700 4 } }
material clear dielectric { ior glass BK7; absorption rgb 1 2 3 }
material paint openpbr { base-color spots; coat-weight 1; coat-ior 1.6 }
material both mix { first gold; second paint; amount 0.3 }
medium fog homogeneous { extinction 0.1 per-m; albedo 0.9; phase henyey-greenstein 0.5 }
shape ball sphere { radius $size; material both; transform { rotate y 20 deg; translate 0 1 0 } }
shape net mesh { material clear; interior fog; points { - 0 0 0; - 1 0 0; - 0 1 0 }; faces { - 0 1 2 } }
object pair { shape a sphere { radius 0.1 }; shape b box { min 0 0 0; max 1 1 1 } }
instance pair { transform { translate 2 0 0 } }
light lamp quad { points 0 2 0  1 2 0  1 2 1  0 2 1; power 800 lm; color blackbody 3000 K }
light room sky { luminance 100 nits }
)";

// Whether the scene has an error. Throws where something that was taken out is used.
bool isRefused(const std::string& scene) {
    BuildOptions options;
    options.geometry = false;
    return TestScene::parse(scene, options).diagnostics().hasErrors();
}

} // namespace

TEST_CASE("damaged scenes: a sign too many, anywhere") {
    const std::size_t step = nightly() ? 1 : 5;
    for (const std::string_view sign : {"\"", "\x1b", "/*", "}", "{", "\\"})
        for (std::size_t i = sign.size(); i < kScene.size(); i += step) {
            std::string scene = kScene;
            scene.insert(i, sign);
            INFO(fmt::format("`{}` at {}: …{}…", sign, i, scene.substr(i - std::min<std::size_t>(i, 20), 40)));
            // A brace may be harmless behind the last one, and a quote within a text.
            CHECK_NOTHROW(isRefused(scene));
        }
}

TEST_CASE("damaged scenes: what is cut off is an error and nothing else") {
    for (std::size_t size = 8; size < kScene.size(); size += nightly() ? 1 : 3) {
        INFO(kScene.substr(size - 8, 8));
        CHECK_NOTHROW(isRefused(kScene.substr(0, size)));
    }
}

TEST_CASE("damaged scenes: an index without an end") {
    CHECK(isRefused("scene 1\ncamera { from 0 0 3; look-at 0 0 0 }\nlight sky { radiance 1 }\n"
                    "shape sphere { radius 1; material conductor { index \"metal } }\n"));
    CHECK_FALSE(isRefused(kScene));
}

} // namespace abbe::test::damaged
