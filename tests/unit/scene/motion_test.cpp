// Instances with keys: where they are while the shutter is open, and what cannot move.
#include "scene_test_fixture.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

const std::string kEyeWithShutter = "scene 1\ncamera { from 0 0 5; look-at 0 0 0; shutter \"1/2\" s }\n" + kSky;
const std::string kBall = "object ball { shape sphere { radius 0.1 } }\n";

// Where a vertical ray at x meets something, at a position in the shutter interval.
bool metAt(const TestScene& scene, double x, double y, float time) {
    SurfaceHit hit;
    const Ray ray{Vec3(Vec3d{x, y, 3} - scene.scene().origin), {0, 0, -1}, kInfinity, time};
    return scene.scene().intersector->intersect(ray, hit);
}

TEST_CASE("motion: an instance goes where its keys say while the shutter is open") {
    const auto scene = TestScene::parse(kEyeWithShutter + kBall +
                                        "instance ball { transform { at 0 s { translate -1 0 0 }\n"
                                        "at 1 s { translate 1 0 0 } } }\n");
    CHECK(codes(scene) == "");
    // Half a second is half of the way.
    CHECK(metAt(scene, -1, 0, 0));
    CHECK(metAt(scene, -0.5, 0, 0.5f));
    CHECK(metAt(scene, 0, 0, 1));
    CHECK_FALSE(metAt(scene, 0, 0, 0));
    CHECK_FALSE(metAt(scene, 1, 0, 1));
}

TEST_CASE("motion: a full turn is one, in a group that stands still") {
    const auto scene = TestScene::parse(kEyeWithShutter + kBall +
                                        "group { transform { translate 0 1 0 }\n"
                                        "instance ball { transform {\n"
                                        "at 0 s { translate 1 0 0; rotate z 0 deg }\n"
                                        "at \"1/2\" s { translate 1 0 0; rotate z 360 deg } } } }\n");
    CHECK(codes(scene) == "");
    CHECK(metAt(scene, 1, 1, 0));
    CHECK(metAt(scene, 0, 2, 0.25f));
    CHECK(metAt(scene, -1, 1, 0.5f));
    CHECK(metAt(scene, 1, 1, 1));
}

TEST_CASE("motion: without a shutter everything stands where it is at time 0") {
    const auto scene = build(kBall + "instance ball { transform { at -1 s { translate -1 0 0 }\n"
                                     "at 1 s { translate 1 0 0 } } }\n");
    CHECK(codes(scene) == "");
    for (const float time : {0.f, 0.4f, 1.f}) CHECK(metAt(scene, 0, 0, time));
}

TEST_CASE("motion: what cannot move yet, and keys that make no sense") {
    const auto with = [](const std::string& body) {
        return codes(TestScene::parse(kEyeWithShutter + kBall + "instance ball\n" + body));
    };
    const std::string keys = "transform { at 0 s { translate 0 0 0 }\nat 1 s { translate 1 0 0 } }";
    CHECK(with("object lamp { light sphere { power 1 W } }\ninstance lamp { " + keys + " }") == "E0634");
    CHECK(with("shape sphere { " + keys + " }") == "E0206");
    CHECK(with("group { " + keys + " }") == "E0206");
    CHECK(with("instance ball { transform { at 1 s { translate 0 0 0 }\nat 1 s { translate 1 0 0 } } }") == "E0313");
    CHECK(with("instance ball { transform { at 1 s { translate 0 0 0 }\ntranslate 1 0 0 } }") == "E0313");
    CHECK(with("instance ball { transform { at 1 m { translate 0 0 0 } } }") == "E0302");
    CHECK(with("instance ball { transform { at 0 s { scale 1 1 1 }\nat \"1/4\" s { scale 1 1 -1 } } }") == "E0631");
}

} // namespace
} // namespace abbe::test
