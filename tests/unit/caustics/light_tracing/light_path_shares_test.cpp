// The largest shares of light paths, and the names of what they are sent to.
#include "caustics/light_tracing/light_path_shares.h"
#include "caustics/shared/aim_targets.h"
#include "support/scene_test.h"

#include <doctest/doctest.h>
#include <string>

namespace abbe::test {

TEST_CASE("light path shares: the largest, and all others in one") {
    std::vector<LightPathShare> shares;
    double all = 0, before = 0;
    for (int i = 0; i < 20; ++i) {
        shares.push_back({"l" + std::to_string(i), "t", 0.01 * ((i * 7) % 20), 1.0 + i, 0.5});
        all += shares.back().share;
        before += shares.back().share > 0 ? shares.back().before : 0;
    }
    const auto largest = largestShares(shares);
    REQUIRE(largest.size() == LightPathFindings::kShares);
    CHECK(largest[0].share == 0.19);
    CHECK(largest[0].light == "l17");
    CHECK(largest.back().light.empty());
    double kept = 0, keptBefore = 0;
    for (const LightPathShare& s : largest) {
        kept += s.share;
        keptBefore += s.before;
    }
    CHECK(kept == doctest::Approx(all));
    CHECK(keptBefore == doctest::Approx(before));
    const auto twice =
        largestShares({{"lamp", "ball", 0.1, 1, 2}, {"lamp", "", 0.5, 0, 0}, {"lamp", "ball", 0.3, 3, 4}});
    REQUIRE(twice.size() == 2); // a lamp that is placed twice
    CHECK(twice[1].share == doctest::Approx(0.4));
    CHECK(twice[1].before == 4);
    CHECK(twice[1].after == 6);
    shares.resize(4);
    CHECK(largestShares(shares).size() == 3); // one of them has nothing
}

TEST_CASE("aim targets have the names of what they are around") {
    const Bounds3 scene{Vec3(-10, -10, -10), Vec3(10, 10, 10)};
    const auto box = [](float x) { return Bounds3{Vec3(x, 0, 0), Vec3(x + 0.01f, 0.01f, 0.01f)}; };
    const AimTargets few = aimTargets({{box(0), "ball"}, {box(5), "ring"}, {box(50), "outside"}}, scene);
    REQUIRE(few.names.size() == few.balls.size());
    CHECK(few.names == std::vector<std::string>{"ball", "ring"});
    std::vector<FocusingShape> many;
    for (int i = 0; i < 100; ++i) many.push_back({box(0.02f * static_cast<float>(i % 10)), "bead" + std::to_string(i)});
    for (int i = 0; i < 10; ++i) many.push_back({box(-8), i % 2 ? "cup" : "saucer"});
    const AimTargets put = aimTargets(many, scene);
    REQUIRE(put.names.size() == 2);
    REQUIRE(put.balls.size() == 2);
    CHECK(put.names[0] == "saucer, cup");
    CHECK(put.names[1] == "bead0, bead1, bead2 and others");
}

TEST_CASE("aim targets: a ball is aimed at itself, not at the ball around its box") {
    const auto scene =
        TestScene::parse("scene 1\ncamera { from 0 0 9; look-at 0 0 0 }\nlight sky { radiance 1 }\n"
                         "material glass dielectric { ior 1.5 }\n"
                         "shape ball sphere { center 0.3 -2 1; radius 0.7; material glass }\n"
                         "shape dice box { min 1 1 1; max 2 2 2; material glass }\n"
                         "shape egg sphere { center 3 0 0; radius 0.5; material glass; transform { scale 1 1.3 1 } }\n"
                         // As much area as the ball in a cube around it.
                         "shape slab box { min 4 0 0; max 5 0.285398 1; material glass }\n"
                         "shape floor plane { material diffuse { reflectance 0.5 } }\n");
    const auto round = boxesOfBalls(scene.scene().surfaces);
    REQUIRE(round.size() == 1);
    const Bounds3 all{Vec3(-50, -50, -50), Vec3(50, 50, 50)};
    const auto& focusing = scene.scene().focusing;
    const AimTargets targets = aimTargets(focusing, all, round), before = aimTargets(focusing, all);
    REQUIRE(targets.balls.size() == 4);
    for (std::size_t i = 0; i < 4; ++i) {
        INFO(targets.names[i]);
        const bool ball = targets.names[i].find("ball") != std::string::npos;
        const float half = 0.5f * maxComponent(focusing[i].box.diagonal());
        CHECK(targets.balls[i].radius == doctest::Approx(ball ? 0.7f : before.balls[i].radius).epsilon(3e-4));
        CHECK(targets.balls[i].radius >= half);
    }
    // A ball that reaches beyond the scene's box, and one among others, are no balls.
    const Bounds3 box = round[0], cut{Vec3(-50, -50, -50), Vec3(50, 50, box.upper.z - 0.1f)};
    const AimTargets part = aimTargets({{box, "ball"}}, cut, round);
    CHECK(part.balls.at(0).radius == doctest::Approx(aimTargets({{box, "ball"}}, cut).balls.at(0).radius));
    std::vector<FocusingShape> many(30, {box, "ball"});
    CHECK(aimTargets(many, all, round).balls.at(0).radius == doctest::Approx(box.radius()).epsilon(1e-3));
}

} // namespace abbe::test
