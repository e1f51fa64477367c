// Dense solids: what is left out in them changes no picture.
#include "support/same_bits.h"
#include "support/scene_test.h"
#include "support/scene_test_compare.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

const std::string kView = "scene 1\nfilm { size 12 12; filter box 0.5 }\n"
                          "camera { from 0 0.5 4; look-at 0 0 0; fov 34 deg }\n"
                          "light sky { radiance 0.3 }\nlight quad { points { - 1 2 1; - 2 2 1; - 2 2 0; - 1 2 0 }; "
                          "two-sided on; radiance 8 }\n";
const std::string kSolid = "shape sphere { radius 1; material subsurface { reflectance 0.7; mean-free-path table 400 3 "
                           "550 8  700 30 cm; boundary ";
const std::string kBoundary = "material boundary; interior homogeneous { extinction table 400 5  700 2 per-m; albedo "
                              "0.9; phase henyey-greenstein 0.4 } ";

bool isLit(const std::string& shapes) {
    const TestScene scene = TestScene::parse(kView + shapes);
    INFO(scene.report());
    const std::vector<MediumUse>& uses = scene.scene().mediumUses;
    REQUIRE(uses.size() == 1);
    return uses[0].lit;
}

} // namespace

TEST_CASE("dense media: where light can come to on a straight way") {
    for (const std::string boundary : {"diffuse", "dielectric"}) {
        CHECK(!isLit(kSolid + boundary + " } }"));
        CHECK(isLit(kSolid + boundary + "; opacity 0.5 } }"));
        CHECK(!isLit(kSolid + boundary + " } }\nlight sphere { center 2 0 0; radius 0.5; power 9 lm }"));
        CHECK(isLit(kSolid + boundary + " } }\nlight sphere { center 0.2 0 0; radius 0.1; power 9 lm }"));
        CHECK(isLit(kSolid + boundary + " } }\nlight point { position 0.2 0 0; power 9 lm }"));
    }
    CHECK(isLit("shape sphere { radius 1; " + kBoundary + "}"));
    CHECK(isLit("volume atmosphere { extinction 0.2 per-m }"));
}

TEST_CASE("dense media: without next-event estimation the mean is the same, whatever may be found") {
    // A boundary lets light through from all sides, and a flame-like glow is none: the worst that could be called
    // unlit.
    TestScene scene =
        TestScene::parse(kView + "shape sphere { radius 1; " + kBoundary + "}\nshape plane { center 0 -1 0 }");
    REQUIRE(scene.report() == "");
    const std::uint32_t samples = 4096;
    const TestImage with = render(scene, samples, 1);
    scene.changeable().mediumUses[0].lit = false;
    const TestImage without = render(scene, samples, 2);
    CHECK(without.statistics.shadowRays < with.statistics.shadowRays);
    checkSame(compareImages(with.film, without.film), 0.01);
}

TEST_CASE("dense media: the surface ahead is looked for no further than the collision, with the same bits") {
    // Beside a medium that nobody meets tracking does not know beforehand where it ends, and looks for all surfaces.
    const std::string hidden = "shape sphere { center 0 -6 0; radius 1 }\n";
    const std::string volume = "volume noise { center 0 -6 0; size 0.5 0.5 0.5; extinction 1 per-m }\n";
    for (const std::string boundary : {"diffuse", "dielectric", "dielectric; roughness 0.2"}) {
        INFO(boundary);
        // Scattered unevenly, so that no walk is pulled to the surface, which does not happen beside that medium.
        const std::string text = kView + hidden + kSolid + boundary + "; anisotropy 0.3 } }\n";
        const TestScene alone = TestScene::parse(text), beside = TestScene::parse(text + volume);
        REQUIRE(alone.report() == "");
        REQUIRE(beside.report() == "");
        const TestImage a = render(alone, 64), b = render(beside, 64);
        CHECK(sameBits(a.film, b.film));
        CHECK(a.statistics.vertices == b.statistics.vertices);
    }
}

} // namespace abbe::test
