// Noise volumes and media, and the atmosphere statement: what the language says of them, and what is said about wrong
// ones.
#include "scene_test_fixture.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

// Density of the scene's only volume at a place in the world, or of the medium that fills things.
float densityAt(const TestScene& scene, Vec3d p) {
    REQUIRE(scene.scene().media.size() == 1);
    WalkSpace space;
    const Vec3 way{0, 0.6f, 0.8f};
    const Ray ray{Vec3(p - scene.scene().origin) - way * 2, way};
    MediumWalk* walk = scene.scene().media[0]->walk(ray, 10, space);
    MediumSegment segment;
    while (walk && walk->next(segment))
        if (segment.tNear <= 2 && segment.tFar >= 2) return walk->density(2);
    return 0;
}

} // namespace

TEST_CASE("noise: a box by its size or its corners, a pattern that stays where it is in the world") {
    const std::string pattern = "scale 0.3; softness 1; coverage 1; edge 0.2; scale-height 50 cm";
    const auto sized = build("volume noise { center 0.2 0.5 -1; size 2 1 3; " + pattern + " }\n");
    const auto corners = build("volume mist noise { min -0.8 0 -2.5; max 1.2 1 0.5; " + pattern + " }\n");
    const auto moved = build("volume noise { size 2 1 3; " + pattern + "; transform { translate 0.2 0.5 -1 } }\n");
    for (const TestScene* scene : {&sized, &corners, &moved}) {
        REQUIRE(scene->report() == "");
        CHECK(scene->scene().effects.has(Effect::media));
        const Bounds3 box = scene->scene().openMedia[0]->bounds();
        const Vec3d lower = Vec3d(box.lower) + scene->scene().origin;
        CHECK(length(lower - Vec3d{-0.8, 0, -2.5}) < 1e-5);
    }
    int filled = 0;
    for (int i = 0; i < 40; ++i) {
        const Vec3d p{-0.7 + 0.04 * i, 0.2 + 0.01 * i, -2 + 0.05 * i};
        filled += densityAt(sized, p) > 0;
        CHECK(densityAt(sized, p) == doctest::Approx(densityAt(corners, p)).epsilon(1e-4));
    }
    CHECK(filled > 35);
    CHECK(densityAt(sized, {3, 0.5, 0}) == 0);
}

TEST_CASE("noise: density falls upwards in scenes where z is up, too") {
    const auto scene = TestScene::parse("scene 1 up=z\ncamera { from 0 -9 0; look-at 0 0 0 }\n" + kSky +
                                        "volume noise { size 2 2 2; contrast 0; scale-height 1 m }\n");
    REQUIRE(scene.report() == "");
    CHECK(densityAt(scene, {0, 0, -1 + 1e-3}) == doctest::Approx(1).epsilon(0.01));
    CHECK(densityAt(scene, {0, 0, 0.5}) == doctest::Approx(std::exp(-1.5)).epsilon(0.01));
    CHECK(densityAt(scene, {0.3, 0.9, 0}) == doctest::Approx(std::exp(-1)).epsilon(0.01));
}

TEST_CASE("noise inside a shape is that of the world, wherever the camera is and whatever it looks at") {
    const std::string ball = "medium smoke noise { scale 0.4; coverage 1; softness 1; extinction 3 per-m }\n"
                             "shape ball sphere { radius 1; material boundary; interior smoke }\n" +
                             kSky;
    const auto near = TestScene::parse("scene 1\ncamera { from 0 0 5; look-at 0 0 0 }\n" + ball);
    const auto far =
        TestScene::parse("scene 1\ncamera { from 20 3 50; look-at 0 0 0; f-stop 2; focus on=ball }\n" + ball);
    REQUIRE(near.report() == "");
    REQUIRE(far.report() == "");
    for (int i = 0; i < 20; ++i) {
        const Vec3d p{0.1 * i - 1, 0.05 * i, 0.3};
        CHECK(densityAt(near, p) == doctest::Approx(densityAt(far, p)).epsilon(1e-3));
    }
}

TEST_CASE("noise: what is wrong is said") {
    for (const auto& [properties, code] : {std::pair{"octaves 0", "E0303"},
                                           {"octaves 17", "E0303"},
                                           {"scale 0", "E0303"},
                                           {"coverage 0", "E0303"},
                                           {"contrast 1.5", "E0303"},
                                           {"softness 0", "E0303"},
                                           {"gain -0.1", "E0303"},
                                           {"lacunarity 0.5", "E0303"},
                                           {"edge -1", "E0303"},
                                           {"seed -1", "E0303"},
                                           {"size 1 0 1", "E0303"},
                                           {"pattern perlin", "E0307"},
                                           {"min 0 0 0", "E0614"},
                                           {"min 0 0 0; max 1 0 1", "E0614"},
                                           {"min 0 0 0; max 1 1 1; size 1 1 1", "E0614"},
                                           {"transform { scale 1 0 1 }", "E0313"},
                                           {"albedo 1; absorption 1 per-m", "E0640"}}) {
        INFO(std::string(properties));
        const auto scene = build(std::string("volume noise { ") + properties + " }\n");
        CHECK(codes(scene).find(code) != std::string::npos);
    }
    CHECK(codes(build("medium m noise { size 1 1 1 }\nshape sphere { interior m }\n")) == "E0201");
}

TEST_CASE("atmosphere: places a medium everywhere") {
    const auto scene = build("atmosphere haze\nmedium haze homogeneous { extinction 0.02 per-km }\n");
    REQUIRE(scene.report() == "");
    REQUIRE(scene.scene().openMedia.size() == 1);
    CHECK(scene.scene().openMedia[0]->bounds().upper.x == kInfinity);
    CHECK(scene.scene().effects.has(Effect::media));
    const auto noisy = build("medium dust noise { scale 3 m }\natmosphere dust\n");
    CHECK(noisy.report() == "");
    CHECK(densityAt(noisy, {0, 0, 0}) >= 0);

    for (const auto& [text, code] : {std::pair{"atmosphere\n", "E0209"},
                                     {"atmosphere haze\n", "E0202"},
                                     {"medium haze homogeneous\natmosphere hase\n", "E0202"},
                                     {"medium haze homogeneous\natmosphere haze 3\n", "E0306"},
                                     {"medium haze homogeneous\natmosphere haze { extinction 2 }\n", "E0201"},
                                     {"medium haze homogeneous\ngroup { atmosphere haze }\n", "E0212"}}) {
        INFO(std::string(text));
        CHECK(codes(build(text)) == code);
    }
    CHECK(build("medium haze homogeneous\natmosphere hase\n").report().find("did you mean `haze`") !=
          std::string::npos);
}

} // namespace abbe::test
