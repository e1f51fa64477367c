// The largest shares of light paths, and the names of what they are sent to.
#include "integrators/aim_targets.h"
#include "integrators/light_path_shares.h"

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

} // namespace abbe::test
