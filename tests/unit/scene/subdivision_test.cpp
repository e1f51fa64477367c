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

// Displacement out of scene text.

using namespace abbe;
using namespace abbe::test;

namespace {

// A square of four faces about the origin, 2 wide, in the xy-plane; flat, so that its limit is itself.
const std::string kSquare = "points { - -1 -1 0; - 1 -1 0; - 1 1 0; - -1 1 0 }\nfaces { - 0 1 2 3 }\n";
const std::string kFolder = std::string(ABBE_SOURCE_DIR) + "/scenes/displaced-stones/";

std::string square(const std::string& more) { return "shape subdivision {\n" + kSquare + more + "dicing 3\n}\n"; }

// A cube 20 wide with texture coordinates.
std::string block(const std::string& more) {
    return "shape subdivision \"" + kFolder + "block.obj\" {\n" + more + "dicing 3\n}\n";
}

std::string vector(const std::string& more) {
    return "displacement 0.5 { map noise { scale 1000; octaves 1 }; kind vector; midpoint 0.1; " + more + " }\n";
}

} // namespace

TEST_CASE("displacement scene: a length in the shape's own space, before its transform") {
    // Noise with a scale beyond everything is nearly constant.
    const std::string up = "displacement 0.5 { map noise { scale 1e6; octaves 1 }; midpoint -0.5 }\n";
    const auto plain = build(square(up));
    REQUIRE(codes(plain) == "");
    const double z = trace(plain, {0.1, 0.2, 4}, {0, 0, -1}).p.z;
    CHECK(z > 0.3);
    CHECK(z < 0.7);
    const auto scaled = build(square(up + "transform { scale 1 1 3; translate 0 0 -0.5 }\n"));
    REQUIRE(codes(scaled) == "");
    CHECK(trace(scaled, {0.1, 0.2, 4}, {0, 0, -1}).p.z == doctest::Approx(3 * z - 0.5).epsilon(1e-4));
    const auto mirrored = build(square(up + "transform { scale 1 1 -1 }\n"));
    const WorldHit hit = trace(mirrored, {0.1, 0.2, -4}, {0, 0, 1});
    REQUIRE(hit.met);
    CHECK(hit.p.z == doctest::Approx(-z).epsilon(1e-4));
    CHECK(hit.hit.ng.z < -0.9f); // the outer side is still outside
    CHECK(hit.hit.shading.z.z < -0.9f);
    CHECK(codes(build("texture t noise\n" + square("displacement 0.1 { map t }\n"))) == "");
    CHECK(codes(build(square("displacement 0 { map noise }\n"))) == "");
}

TEST_CASE("displacement scene: vectors in both spaces") {
    for (const std::string space : {"space object", "space tangent", ""}) {
        const auto scene = build(block(vector(space)));
        REQUIRE(codes(scene) == "W0696"); // the camera is in the block
        CHECK(trace(scene, {0, 0, 40}, {0, 0, -1}).met);
    }
}

TEST_CASE("displacement scene: mistakes have a code and a place") {
    CHECK(codes(build(square("displacement 0.1\n"))) == "E0207");
    CHECK(codes(build(square("displacement 0.1 { midpoint 0 }\n"))) == "E0207");
    CHECK(codes(build(square("displacement 0.1 { map nothing }\n"))) == "E0202");
    CHECK(codes(build(square("displacement 0.1 { map noise; space object }\n"))) == "E0310");
    CHECK(codes(build(square("displacement 0.1 { map noise; kind vektor }\n"))) == "E0307");
    CHECK(codes(build(square("displacement 0.1 { map noise; kind vector }\n"))) == "E0670");
    CHECK(codes(build(square("displacement 0.1 px { map noise }\n"))) == "E0302");
    CHECK(codes(build(square("displacement 0.1 { map image \"nowhere.exr\" }\n"))) == "E0401");
    CHECK(codes(build(square("displacement 0.1 { map noise { scale 0 } }\n"))) == "E0303");
    CHECK(codes(build("texture t image\n")) == "W0201 E0207"); // and nothing uses it
    CHECK(codes(build("texture t\n")) == "E0211");
    const auto mesh = build("shape mesh { " + kSquare + "displacement 0.1 { map noise }\n}\n");
    CHECK(codes(mesh) == "E0201");
    CHECK(mesh.advice().find("scheme bilinear") != std::string::npos);
}

TEST_CASE("displacement scene: images are looked up, checked and told apart") {
    const std::string image = "displacement 0.1 { map image \"" + kFolder + "weave.pgm\"";
    CHECK(codes(build(block(image + " space=data }\n"))) == "W0696");
    CHECK(codes(build(block(image + " }\n"))) == "W0450 W0696");
    CHECK(codes(build(square(image + " space=data }\n"))) == "E0670");
    CHECK(codes(build(block(image + " space=data; kind vector }\n"))) == "E0671");
    CHECK(codes(build(block("displacement 0.1 { map image \"" + kFolder + "README.md\" }\n"))) == "E0402");
}
