// Curves and points in white surroundings: what is white cannot be seen, and what is grey and convex is evenly grey,
// unless a surface shadows itself.
#include "support/scene_test.h"
#include "support/scene_test_compare.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

constexpr const char* kCurvesHeader = "scene 1\nfilm { size 16 16; filter box 0.5 }\nlight sky { radiance 1 }\n"
                                      "camera { from 0 0 4; look-at 0 0 0; fov 25 deg }\n";

// `shape` with a place for "count"-many points and the rest of the block.
std::string cloud(const std::string& head, int count, double scale) {
    Random random(5);
    std::string points;
    for (int i = 0; i < count; ++i)
        points += fmt::format("- {} {} {}; ", scale * (1.6 * random.uniform() - 0.8),
                              scale * (1.6 * random.uniform() - 0.8), scale * (1.6 * random.uniform() - 0.8));
    return head + " points { " + points + "} }\n";
}

void checkEven(const std::string& shape, double expected, std::uint32_t samples, double resolution) {
    INFO(shape.substr(0, 120));
    const auto scene = TestScene::parse(kCurvesHeader + shape);
    REQUIRE(scene.report() == "");
    const TestImage image = render(scene, samples);
    checkSame(compareExpected(image.film, [&](int, int) { return expected; }), resolution);
    CHECK(image.statistics.dropped == std::array<std::uint64_t, 3>{});
    CHECK(image.statistics.cappedPaths == 0);
}

} // namespace

TEST_CASE("white spheres, disks, tubes and ribbons in white surroundings cannot be seen") {
    const std::string white = "material diffuse { reflectance 1 }; ";
    for (const char* form : {"sphere", "disk"})
        checkEven(cloud(fmt::format("shape points {{ {} form {}; radius 0.15;", white, form), 60, 1), 1, 128, 0.004);
    for (const char* basis : {"linear", "bspline", "catmull-rom", "bezier"})
        for (const char* form : {"round", "flat"})
            checkEven(
                cloud(fmt::format("shape curves {{ {} basis {}; form {}; radius 0.06;", white, basis, form), 31, 1), 1,
                128, 0.004);
}

// Case 43, end to end: light enters and leaves fibres many times, tubes through their far sides too.
TEST_CASE("white hair in white surroundings cannot be seen") {
    for (const char* form : {"round", "flat"})
        for (const char* roughness : {"0.01", "0.3", "1"})
            checkEven(cloud(fmt::format("shape curves {{ material hair {{ longitudinal-roughness {0}; "
                                        "azimuthal-roughness {0} }}; basis bspline; form {1}; radius 0.06;",
                                        roughness, form),
                            31, 1),
                      1, 128, 0.004);
}

// Under light from far away a straight tube and a ribbon of hair differ in nothing: the same place across the fibre,
// the same fibre. The sun stands behind, where light has to pass the fibre and, in the tube, its far side.
TEST_CASE("a tube of hair looks like a ribbon of hair") {
    const auto picture = [](const char* form, const char* sun) {
        const auto scene = TestScene::parse(fmt::format(
            "scene 1\nfilm {{ size 16 16; filter box 0.5 }}\ncamera {{ from 0 0 4; look-at 0 0 0; fov 20 deg }}\n"
            "light sun {{ toward {}; angular-diameter 20 deg; irradiance 100 klx }}\nlight sky {{ radiance 1 }}\n"
            "shape curves {{ basis bspline; form {}; radius 0.5; material hair {{ eumelanin 0.3 }}\n"
            "points {{ - -1.5 -6 1; - -0.5 -2 0.3333333; - 0.5 2 -0.3333333; - 1.5 6 -1 }} }}\n",
            sun, form));
        REQUIRE(scene.report() == "");
        return render(scene, 512);
    };
    for (const char* sun : {"0.3 0.4 -1", "0.8 0.2 1"}) {
        const TestImage tube = picture("round", sun), ribbon = picture("flat", sun);
        checkSame(compareImages(tube.film, ribbon.film), 0.004);
    }
}

// A grey surface that no other part of it can see shows its reflectance, at any distance from the camera and any size.
// Any false shadow makes it darker.
TEST_CASE("grey tubes and spheres that fill the view are evenly grey") {
    const std::string grey = "material diffuse { reflectance 0.5 }; ";
    checkEven("shape points { " + grey + "radius 20; points { - 0 0 -20.5 } }\n", 0.5, 128, 0.002);
    checkEven("shape points { " + grey + "form disk; radius 12; points { - 0 0 -30 } }\n", 0.5, 128, 0.002);
    for (const char* basis : {"linear", "bspline", "catmull-rom", "bezier"})
        checkEven(fmt::format(
                      "shape curves {{ {} basis {}; radius 20; points {{ - 0 -60 -21; - 0 -20 -21; - 0 20 -21; - 0 60 "
                      "-21 }} }}\n",
                      grey, basis),
                  0.5, 128, 0.002);
}

} // namespace abbe::test
