// Boxes, cylinders, cones and tori in scenes: what they mean, and what is wrong with some of them.
#include "scene_test_fixture.h"

#include <doctest/doctest.h>

namespace abbe::test {

TEST_CASE("parametric: about their centre, upright, in the units that were written") {
    const auto scene = build("shape box { center 0 1 0; size 2 40 60 cm }\n"
                             "shape box { min 3 0 -1; max 4 2 1 }\n"
                             "shape cylinder { center -3 0 0; radius 0.5; height 2 }\n"
                             "shape cone { center -6 0 0; radius 1; height 2 }\n"
                             "shape torus { center 0 0 -9; major-radius 1; minor-radius 0.25 }\n");
    REQUIRE(scene.report() == "");
    CHECK(scene.built().facts.quads == 12);
    CHECK(scene.built().facts.analytic == 3);
    CHECK(near(trace(scene, {0, 1, 5}, {0, 0, -1}).p, {0, 1, 0.3}));
    CHECK(near(trace(scene, {3.5, 9, 0}, {0, -1, 0}).p, {3.5, 2, 0}));
    CHECK(near(trace(scene, {-3, 0.9, 5}, {0, 0, -1}).p, {-3, 0.9, 0.5}));
    CHECK(near(trace(scene, {-3, 5, 0.2}, {0, -1, 0}).p, {-3, 1, 0.2}));
    CHECK(near(trace(scene, {-6, 0, 5}, {0, 0, -1}).p, {-6, 0, 0.5}));
    CHECK(near(trace(scene, {1, 5, -9}, {0, -1, 0}).p, {1, 0.25, -9}));
    CHECK_FALSE(trace(scene, {0, 5, -9}, {0, -1, 0}).met);
}

TEST_CASE("parametric: axes, open ends, and where z is up") {
    const auto scene = build("shape cylinder { axis 1 0 0; radius 0.5; height 4; caps off }\n"
                             "shape cone { center 0 3 0; axis 0 -2 0; radius 1; top-radius 0.5; height 1 }");
    REQUIRE(scene.report() == "");
    CHECK(near(trace(scene, {1.9, 0, 5}, {0, 0, -1}).p, {1.9, 0, 0.5}));
    CHECK_FALSE(trace(scene, {5, 0, 0}, {-1, 0, 0}).met);
    CHECK(near(trace(scene, {0.9, 9, 0}, {0, -1, 0}).p, {0.9, 3.5, 0})); // the wide end is up
    CHECK(near(trace(scene, {0, 1, 0}, {0, 1, 0}).p, {0, 2.5, 0}));
    const auto zUp = TestScene::parse("scene 1 up=z\ncamera { from 0 -5 1 }\n" + kSky + "shape cylinder { height 4 }");
    REQUIRE(zUp.report() == "");
    CHECK(near(trace(zUp, {0.2, 0, 9}, {0, 0, -1}).p, {0.2, 0, 2}));
}

TEST_CASE("parametric: placed by any transform, as instances, as lights") {
    const std::string place = "transform { scale 1 0.5 -2; rotate z 30 deg; translate 0.3 1 0 }";
    for (const std::string type :
         {"box { size 1 2 1.5", "cylinder { radius 0.7", "cone { height 1.5", "torus { major-radius 0.8"}) {
        INFO(type);
        const auto baked = build("shape " + type + "; " + place + " }");
        const auto instanced = build("object thing { shape " + type + " } }\ninstance thing { " + place + " }");
        REQUIRE(baked.report() == "");
        REQUIRE(instanced.report() == "");
        int met = 0;
        for (int i = 0; i < 400; ++i) {
            const Vec3d from{-1.5 + 0.15 * (i % 20), -0.5 + 0.15 * (i / 20) + 0.01, 9};
            const WorldHit a = trace(baked, from, {0.05, 0.02, -1}), b = trace(instanced, from, {0.05, 0.02, -1});
            REQUIRE(a.met == b.met);
            if (!a.met) continue;
            ++met;
            CHECK_UNARY(near(a.p, b.p, 1e-5));
            CHECK_UNARY(near(Vec3d(a.hit.ng), Vec3d(b.hit.ng), 1e-4));
        }
        CHECK(met > 8);
        const auto light = build("shape " + type + "; emission 2; " + place + " }");
        REQUIRE(light.report() == "");
        CHECK(light.scene().lights.size() == 2);
    }
}

TEST_CASE("parametric: mistakes have a place and a name") {
    CHECK(codes(build("shape torus { major-radius 0.2; minor-radius 0.3 }")) == "E0613");
    CHECK(codes(build("shape torus { major-radius 1; minor-radius 1e-9 }")) == "E0613");
    CHECK(codes(build("shape torus { major-radius 0.2; minor-radius 0.2 }")) == "");
    CHECK(codes(build("shape box { size 1 1 1; min 0 0 0; max 1 1 1 }")) == "E0614");
    CHECK(codes(build("shape box { min 0 0 0 }")) == "E0614");
    CHECK(codes(build("shape box { min 0 0 0; max 1 0 1 }")) == "E0614");
    CHECK(codes(build("shape box { size 1 0 1 }")) == "E0303");
    CHECK(codes(build("shape cone { radius 0 }")) == "E0604");
    CHECK(codes(build("shape cylinder { axis 0 0 0 }")) == "E0604");
    CHECK(codes(build("shape cylinder { radius -1 }")) == "E0303");
    CHECK(codes(build("shape cylinder { center 1e17 0 0 }")) == "E0303");
    CHECK(codes(build("shape cylinder { caps maybe }")) == "E0308");
    const auto torus = build("shape torus { major-radius 0.2; minor-radius 0.3 }");
    REQUIRE(torus.diagnostics().all().size() == 1);
    CHECK(torus.diagnostics().all()[0].span.valid());
    CHECK(torus.report().find("crosses itself") != std::string::npos);
}

} // namespace abbe::test
