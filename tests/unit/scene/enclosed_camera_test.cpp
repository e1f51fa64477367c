// A camera inside of an opaque body is found before anything is rendered.
#include "scene_test_fixture.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

// With the camera at (0, 0, 5).
std::string found(const std::string& body) { return codes(build(body)); }

} // namespace

TEST_CASE("camera: inside of an opaque body it sees nothing") {
    const std::string ball = "shape ball sphere { center 0 0 5; radius 1; material diffuse }\n";
    const auto scene = build(ball);
    CHECK(codes(scene) == "W0696");
    CHECK(scene.diagnostics().all()[0].help == "move the camera out of `ball`: its picture would be black");
    CHECK(found("shape box { center 0 0 5; size 1 1 1; material conductor { index metal Au } }\n") == "W0696");
    CHECK(found(ball + "light point { position 0 9 5; intensity 5 cd }\n") == "W0696"); // outside
}

TEST_CASE("camera: in rooms, glass and open bodies it sees") {
    const std::string room = "shape box { center 0 0 5; size 4 4 4; material diffuse }\n";
    CHECK(found(room + "light point { position 1 1 5; intensity 5 cd }\n") == "");
    CHECK(found(room + "light quad { size 0.1 0.1; luminance 5 nits; transform { translate 0 1.9 5 } }\n") == "");
    // A lamp behind a column: what the camera sees is lit.
    CHECK(found(room + "shape cylinder { center 0.5 0 5; radius 0.2; height 1; material diffuse { reflectance 0.4 } }\n"
                       "light point { position 1.5 0 5; intensity 5 cd }\n") == "");
    CHECK(found("shape sphere { center 0 0 5; radius 1; material dielectric }\n") == "");
    CHECK(found("shape sphere { center 0 0 5; radius 1; material diffuse { opacity 0.5 } }\n") == "");
    CHECK(found("shape sphere { center 0 0 5; radius 1; emission 1 }\n") == "");
    CHECK(found("shape sphere { center 0 0 0; radius 1; material diffuse }\n") == "");
    CHECK(found("shape cylinder { center 0 0 5; radius 1; height 2; caps off; material diffuse }\n") == "");
}

} // namespace abbe::test
