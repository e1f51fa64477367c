// Subdivision surfaces out of scene text.
#include "scene_test_fixture.h"

#include <doctest/doctest.h>

using namespace abbe;
using namespace abbe::test;

namespace {

const std::string kCube =
    "points { - -1 -1 -1; - 1 -1 -1; - -1 1 -1; - 1 1 -1; - -1 -1 1; - 1 -1 1; - -1 1 1; - 1 1 1 }\n"
    "faces { - 0 2 3 1; - 4 5 7 6; - 0 1 5 4; - 2 6 7 3; - 0 4 6 2; - 1 3 7 5 }\n";
const std::string kSharp = "crease 0 1 3 2 0\ncrease 4 5 7 6 4\ncrease 0 4\ncrease 1 5\ncrease 2 6\ncrease 3 7\n";

std::string shape(const std::string& more) { return "shape subdivision {\n" + kCube + more + "}\n"; }

} // namespace

TEST_CASE("subdivision scene: creases keep the cube, without them it shrinks") {
    const auto sharp = build(shape(kSharp));
    REQUIRE(codes(sharp) == "");
    CHECK(near(trace(sharp, {0.7, 0.6, 4}, {0, 0, -1}).p, {0.7, 0.6, 1}));
    const auto smooth = build(shape(""));
    REQUIRE(codes(smooth) == "");
    const WorldHit hit = trace(smooth, {0, 0, 4}, {0, 0, -1});
    CHECK(hit.met);
    CHECK(hit.p.z < 0.9);
    CHECK(!trace(smooth, {0.9, 0.9, 4}, {0, 0, -1}).met);
}

TEST_CASE("subdivision scene: mirrored and in objects the outer side stays outside") {
    for (const std::string& body : {shape("transform { scale -1 1 1 }\n"),
                                    "object o { " + shape("") + " }\ninstance o { transform { scale -1 1 1 } }\n"}) {
        const auto scene = build(body);
        REQUIRE(codes(scene) == "");
        const WorldHit hit = trace(scene, {0.1, 0.1, 4}, {0, 0, -1});
        REQUIRE(hit.met);
        CHECK(hit.hit.ng.z > 0.9f);
        CHECK(hit.hit.shading.z.z > 0.9f);
    }
}

TEST_CASE("subdivision scene: the budget warns before it dices") {
    const auto scene = build(shape("dicing 9\nmemory 4\n"));
    CHECK(codes(scene) == "W0661");
    CHECK(scene.report().find("level 5 instead of 9") != std::string::npos);
    CHECK(codes(build(shape("dicing 5\nmemory 4\n"))) == "");
}

TEST_CASE("subdivision scene: mistakes have a code and a place") {
    CHECK(codes(build(shape("crease 0 7 sharpness=2\n"))) == "E0660");
    CHECK(codes(build(shape("crease 0\n"))) == "E0660");
    CHECK(codes(build(shape("crease 0 1 sharp=2\n"))) == "E0210");
    CHECK(codes(build(shape("crease 0 1 sharpness=-2\n"))) == "E0303");
    CHECK(codes(build(shape("crease 0 1.5\n"))) == "E0309");
    CHECK(codes(build(shape("corner 9\n"))) == "E0660");
    CHECK(codes(build(shape("holes 6\n"))) == "E0660");
    CHECK(codes(build(shape("holes 0 1 2 3 4 5\n"))) == "E0604");
    CHECK(codes(build(shape("scheme loop\n"))) == "E0660");
    CHECK(codes(build(shape("dicing 2.5\n"))) == "E0303");
    CHECK(codes(build(shape("dicing 11\n"))) == "E0303");
    CHECK(codes(build(shape("dicing 0 px\n"))) == "E0303");
    CHECK(build(shape("crease 0 7 sharpness=2\n")).report().find("no edge of a face") != std::string::npos);
}
