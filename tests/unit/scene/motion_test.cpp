// Transforms with keys: where things are while the shutter is open, and what cannot move.
#include "scene_test_fixture.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

const std::string kEyeWithShutter = "scene 1\ncamera { from 0 0 5; look-at 0 0 0; shutter \"1/2\" s }\n" + kSky;
const std::string kMovingBall = "object ball { shape sphere { radius 0.1 } }\n";

// Where a vertical ray at x meets something, at a position in the shutter interval.
bool metAt(const TestScene& scene, double x, double y, float time) {
    SurfaceHit hit;
    const Ray ray{Vec3(Vec3d{x, y, 3} - scene.scene().origin), {0, 0, -1}, kInfinity, time};
    return scene.scene().intersector->intersect(ray, hit);
}

TEST_CASE("motion: an instance goes where its keys say while the shutter is open") {
    const auto scene = TestScene::parse(kEyeWithShutter + kMovingBall +
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
    const auto scene = TestScene::parse(kEyeWithShutter + kMovingBall +
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
    const auto scene = build(kMovingBall + "instance ball { transform { at -1 s { translate -1 0 0 }\n"
                                           "at 1 s { translate 1 0 0 } } }\n");
    CHECK(codes(scene) == "");
    for (const float time : {0.f, 0.4f, 1.f}) CHECK(metAt(scene, 0, 0, time));
}

const std::string kSlide = "transform { at 0 s { translate -1 0 0 }\nat 1 s { translate 1 0 0 } }";

// In half a second from x = -1 to 0.
void checkSlide(const TestScene& scene) {
    INFO(scene.report());
    CHECK(codes(scene) == "");
    CHECK(metAt(scene, -1, 0, 0));
    CHECK(metAt(scene, -0.5, 0, 0.5f));
    CHECK(metAt(scene, 0, 0, 1));
    CHECK_FALSE(metAt(scene, 0, 0, 0));
    CHECK_FALSE(metAt(scene, -1, 0, 1));
}

TEST_CASE("motion: shapes, groups, placements and what nests in them") {
    const std::string ball = "shape sphere { radius 0.1 }\n";
    for (const std::string& body : {
             "shape sphere { radius 0.1; " + kSlide + " }",
             "shape box { size 0.2 0.2 0.2; " + kSlide + " }",
             "group { " + kSlide + "\n" + ball + " }",
             "group { " + kSlide + "\ngroup { transform { translate 0 0 0.1 }\n" + ball + " } }",
             "group { " + kSlide + "\ninstance ball }",
             "instances ball { grid 1 1 1; " + kSlide + " }",
             "group { " + kSlide + "\ninstances ball { grid 1 1 2 } }",
             "object moving { shape sphere { radius 0.1; " + kSlide + " } }\ninstance moving",
             "object moving { " + kSlide + "\n" + ball + " }\ninstance moving",
             "object moving { instance ball { " + kSlide + " } }\ninstance moving",
             "object moving { group { " + kSlide +
                 "\ninstance ball } }\nobject outer { instance moving }\ninstance outer",
         })
        checkSlide(TestScene::parse(kEyeWithShutter + kMovingBall +
                                    "instance ball { transform { translate 0 9 0 } }\n" + body));
}

TEST_CASE("motion: what moves in something that moves has both motions") {
    const std::string rise = "transform { at 0 s { translate 0 0 0 }\nat 1 s { translate 0 2 0 } }";
    const std::string ball = "sphere { radius 0.1; " + kSlide + " }";
    for (const std::string& body : {
             "group { " + rise + "\nshape " + ball + " }",
             "group { " + rise + "\ngroup { " + kSlide + "\nshape sphere { radius 0.1 } } }",
             "group { " + rise + "\ninstance ball { " + kSlide + " } }",
             "group { " + rise + "\nlight sphere { radius 0.1; power 1 W; " + kSlide + " } }",
             "object moving { shape " + ball + " }\ninstance moving { " + rise + " }",
             "object moving { light sphere { radius 0.1; power 1 W; " + kSlide + " } }\ninstance moving { " + rise +
                 " }",
             "object moving { group { " + rise + "\nshape " + ball + " } }\ninstance moving",
             "object lit { light sphere { radius 0.1; power 1 W; " + kSlide +
                 " } }\n"
                 "object moving { instance lit { " +
                 rise + " } }\ninstance moving",
         }) {
        const auto scene = TestScene::parse(kEyeWithShutter + kMovingBall +
                                            "instance ball { transform { translate 0 9 0 } }\n" + body);
        INFO(body << scene.report());
        CHECK(codes(scene) == "");
        CHECK(metAt(scene, -1, 0, 0));
        CHECK(metAt(scene, -0.5, 0.5, 0.5f));
        CHECK(metAt(scene, 0, 1, 1));
        CHECK_FALSE(metAt(scene, 0, 0, 1));
        CHECK_FALSE(metAt(scene, -1, 1, 1));
    }
}

// The tip of a blade of length 1 that turns by 170°, while a matrix mixed by entries would pass close to the axis.
TEST_CASE("motion: a blade that turns by 170° keeps its length, as a shape and in a group") {
    const std::string turn = "transform { at 0 s { rotate z 0 deg }\nat \"1/2\" s { rotate z 170 deg } }";
    const std::string mixed =
        "transform { at 0 s { matrix 1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1 }\nat \"1/2\" s { rotate z 170 deg } }";
    const std::string blade = "quad { points 0 -0.02 0  1 -0.02 0  1 0.02 0  0 0.02 0";
    for (const std::string& body :
         {"shape " + blade + "; " + turn + " }", "group { " + turn + "\nshape " + blade + " } }",
          "shape " + blade + "; " + mixed + " }", "group { " + mixed + "\nshape " + blade + " } }"}) {
        const auto scene = TestScene::parse(kEyeWithShutter + body);
        INFO(scene.report());
        for (int i = 0; i <= 20; ++i) {
            const double angle = 170 * kPiD / 180 * i / 20;
            const float time = static_cast<float>(i) / 20;
            CHECK(metAt(scene, 0.995 * std::cos(angle), 0.995 * std::sin(angle), time));
            CHECK_FALSE(metAt(scene, 1.005 * std::cos(angle), 1.005 * std::sin(angle), time));
        }
    }
}

// A hit on anything that moves names an instance.
bool stands(const TestScene& scene) {
    SurfaceHit hit;
    const Ray ray{Vec3(Vec3d{0, 0, 3} - scene.scene().origin), {0, 0, -1}, kInfinity, 0};
    return scene.scene().intersector->intersect(ray, hit) && hit.instance == SurfaceHit::kNoInstance;
}

TEST_CASE("motion: keys that change nothing while the shutter is open cost nothing") {
    const auto with = [](const std::string& keys) {
        return TestScene::parse(kEyeWithShutter + "shape sphere { radius 0.5; transform { " + keys + " } }");
    };
    CHECK(stands(with("at 0 s { rotate z 0 deg }\nat 1 s { rotate z 0 deg }")));
    CHECK(stands(with("at 0 s { scale 1 }\nat 1 s { rotate z 0 deg }")));
    CHECK(stands(with("at 2 s { translate 0 0 0 }\nat 3 s { translate 0.1 0 0 }")));
    CHECK(stands(with("at -1 s { translate 0.1 0 0 }\nat 0 s { translate 0 0 0 }")));
    CHECK(stands(with("at 1 s { translate 0 0 0 }")));
    CHECK(stands(build("shape sphere { radius 0.5; transform { at 0 s { scale 1 }\nat 1 s { translate 1 0 0 } } }")));
    CHECK_FALSE(stands(with("at 0 s { rotate z 0 deg }\nat 1 s { rotate z 360 deg }")));
    CHECK_FALSE(stands(with("at 0 s { scale 1 }\nat 1 s { translate 0.1 0 0 }")));
}

TEST_CASE("motion: the shutter opens at `time`, and its ramps make it longer") {
    const auto scene = TestScene::parse("scene 1\ncamera { from 0 0 5; look-at 0 0 0; time \"1/4 s\"\n"
                                        "shutter \"1/4 s\" { opening 0.5; closing 1.5 } }\n" +
                                        kSky + "shape sphere { radius 0.1; " + kSlide + " }");
    CHECK(codes(scene) == "");
    CHECK(scene.built().shutter.open == 0.25);
    CHECK(scene.built().shutter.duration == 0.5);
    CHECK(metAt(scene, -0.5, 0, 0));
    CHECK(metAt(scene, 0.5, 0, 1));
}

TEST_CASE("motion: cameras move by `at` and by `transform`") {
    const auto rayOf = [](const std::string& camera, float time) {
        const auto scene =
            TestScene::parse("scene 1\nfilm { size 10 10 }\ncamera { shutter 1 s\n" + camera + " }\n" + kSky);
        INFO(scene.report());
        REQUIRE(!scene.diagnostics().hasErrors());
        CameraSample sample;
        sample.film = {5, 5};
        sample.time = time;
        Ray ray = scene.scene().camera->ray(sample).ray;
        ray.origin = Vec3(Vec3d(ray.origin) + scene.scene().origin);
        return ray;
    };
    // Two of the last camera, half way: a matrix keyed the same.
    for (const char* camera :
         {"look-at 0 0 0\nat 0 s { from 0 0 5 }\nat 1 s { from 5 0 0 }",
          "transform { at 0 s { translate 0 0 5 }\nat 1 s { rotate y 90 deg; translate 5 0 0 } }"}) {
        for (const float time : {0.f, 0.5f, 1.f}) {
            const Ray ray = rayOf(camera, time);
            const double t = static_cast<double>(time), angle = t * kPiD / 2;
            CHECK(near(Vec3d(ray.origin), Vec3d{5 * t, 0, 5 * (1 - t)}, 1e-5));
            CHECK(near(Vec3d(ray.direction), Vec3d{-std::sin(angle), 0, -std::cos(angle)}, 1e-5));
        }
    }
}

TEST_CASE("motion: what cannot move, and keys that make no sense") {
    const auto with = [](const std::string& body) {
        return codes(TestScene::parse(kEyeWithShutter + kMovingBall + "instance ball\n" + body));
    };
    const std::string stretch = "transform { at 0 s { scale 1 1 1 }\nat 1 s { scale 1 2 1 } }";
    CHECK(with("shape plane { " + kSlide + " }") == "E0634");
    CHECK(with("group { " + kSlide + "\nshape plane }") == "E0634");
    CHECK(with("object floor { shape plane }\ninstance floor { " + kSlide + " }") == "E0634");
    CHECK(with("light sphere { power 1 W; " + stretch + " }") == "E0634");
    CHECK(with("light point { power 1 W; " + stretch + " }") == "E0634");
    CHECK(with("shape sphere { emission 1; " + stretch + " }") == "E0634");
    CHECK(with("group { " + stretch + "\nlight sphere { power 1 W } }") == "E0634");
    CHECK(with("object lamp { light sphere { power 1 W } }\ninstance lamp { " + stretch + " }") == "E0634");
    CHECK(with("shape sphere { " + stretch + " }") == "");
    CHECK(with("light sphere { power 1 W; transform { at 0 s { scale 1 }\nat 1 s { scale 2 } } }") == "");
    for (const char* what : {"instance ball", "shape sphere", "group", "light point", "instances ball"}) {
        const std::string rest = std::string(what) == "light point"      ? "power 1 W; "
                                 : std::string(what) == "instances ball" ? "grid 1 1 1; "
                                                                         : "";
        const auto at = [&](const std::string& keys) {
            return with(what + (" { " + rest) + "transform { " + keys + " } }");
        };
        CHECK(at("at 1 s { translate 0 0 0 }\nat 1 s { translate 1 0 0 }") == "E0313");
        CHECK(at("at 1 s { translate 0 0 0 }\nat 0 s { translate 1 0 0 }") == "E0313");
        CHECK(at("at 1 s { translate 0 0 0 }\ntranslate 1 0 0") == "E0313");
        CHECK(at("at 1 m { translate 0 0 0 }") == "E0302");
        CHECK(at("at #nan s { translate 0 0 0 }") == "E0305");
        CHECK(at("at 0 s { translate 0 0 0 }\nat 1 s { translate #nan 0 0 }") == "E0305");
        CHECK(at("at { translate 0 0 0 }") == "E0306");
        CHECK(at("at 0 s { scale 0 }") == "E0313");
    }
    CHECK(with("instance ball { transform { at 0 s { scale 1 1 1 }\nat \"1/4\" s { scale 1 1 -1 } } }") == "E0631");
    CHECK(with("shape sphere { transform { at 0 s { scale 1 1 1 }\nat \"1/4\" s { scale 1 1 -1 } } }") == "E0631");
    const auto camera = [](const std::string& body) {
        return codes(TestScene::parse("scene 1\ncamera { " + body + " }\n" + kSky));
    };
    CHECK(camera("at 0 s { from 0 0 5 }\nat 0 s { from 0 0 4 }") == "E0313");
    CHECK(camera("at 0 s { from 0 0 5; from 0 0 4 }") == "E0208");
    CHECK(camera("at 0 s { fov 40 deg }") == "E0201");
    CHECK(camera("look-at 0 0 0\nat 0 s { from 0 0 0 }") == "E0352");
    CHECK(camera("at 0 s { from 0 0 5 }\ntransform { translate 0 0 1 }") == "E0350");
    CHECK(camera("shutter 1 s\ntransform { at 0 s { scale 1 }\nat 1 s { scale 2 } }") == "E0351");
    CHECK(camera("shutter 1 s { opening 1.5; closing 1 }") == "E0357");
    CHECK(camera("shutter 1 s { opening -1 }") == "E0303");
}

} // namespace
} // namespace abbe::test
