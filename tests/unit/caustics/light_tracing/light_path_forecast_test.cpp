// What is predicted of light paths where it is known: light of one density, and what camera paths miss.
// The largest shares of light paths, and the names of what they are sent to.
#include "caustics/light_tracing/light_path_forecast.h"
#include "caustics/shared/aim_targets.h"
#include "caustics/shared/emission_learning.h"
#include "caustics/shared/pilot.h"
#include "support/scene_test.h"
#include "support/statistics.h"

#include <doctest/doctest.h>
#include <numeric>
#include <string>

namespace abbe::test {
namespace {

constexpr PixelBounds kFrame{0, 0, 32, 32};
constexpr double kPixels = 32 * 32;

// Light paths that bring luminance `y` to every pixel, each to one of them, `count` of them in all.
std::vector<LightDeposit> even(double y, double rho, int count = 4096) {
    std::vector<LightDeposit> result;
    for (int i = 0; i < count; ++i) {
        LightDeposit d;
        d.x = i % 32;
        d.y = i / 32 % 32;
        d.luminance = y; // one of as many as there are pixels
        d.stands = kPixels / count;
        d.rho = rho;
        result.push_back(d);
    }
    return result;
}

} // namespace

TEST_CASE("light path forecast: noise counts over what a pixel shows and a tenth of the mean") {
    const RouletteReference unknown;
    std::vector<LightDeposit> deposits = even(2, 1);
    std::erase_if(deposits, [](const LightDeposit& d) { return d.x < 16; }); // half of the frame is dark
    const NoiseMeasure measure(kFrame, unknown, deposits);
    CHECK(measure.mean() == doctest::Approx(1));
    CHECK(measure.weight(20, 7) == doctest::Approx(1 / 4.01));
    CHECK(measure.weight(3, 7) == doctest::Approx(1 / 0.01));
    CHECK(NoiseMeasure(kFrame, unknown, {}).weight(3, 7) == 0);
}

TEST_CASE("light path forecast: by the balance heuristic, seen by camera paths or not") {
    const RouletteReference unknown;
    constexpr double rho = 0.25, weight = 1 / 1.01; // one in four camera paths for each light path
    const std::vector<LightDeposit> deposits = even(1, rho);
    const NoiseMeasure measure(kFrame, unknown, deposits);
    const LightPathForecast forecast(deposits, kFrame, measure);
    const CameraNoise blind;
    for (const double share : {0.0, 0.5, 4.0}) {
        CAPTURE(share);
        CHECK(forecast.variance(share, blind) == doctest::Approx(weight / (rho + share)));
    }
    // Seen in full, half as noisy in the mean of 64 samples: 512 have 1/2^1.5 of it.
    CameraNoise seen;
    seen.alone.all = CameraVariance::ofPixel(weight / rho, weight * (1 / rho - 1), weight * (1 / rho - 1) / 2);
    const double planned = seen.alone.all.planned;
    CHECK(planned == doctest::Approx(weight * (1 / rho - 1) / std::pow(2, 1.5)));
    CHECK(forecast.variance(0, seen) == doctest::Approx(planned));
    CHECK(forecast.variance(1, seen) == doctest::Approx(planned * 0.04 + weight / 1.5625));
    CHECK(forecast.fireflies() == doctest::Approx(weight / rho));
    CHECK(LightPathForecast(even(1, 1), kFrame, measure).fireflies() == 0); // all camera paths find it
}

TEST_CASE("light path forecast: what is met once in a million is no reason") {
    const RouletteReference unknown;
    std::vector<LightDeposit> deposits = even(1, 0.25);
    const NoiseMeasure measure(kFrame, unknown, deposits);
    const double usual = LightPathForecast(deposits, kFrame, measure).variance(0, {});
    for (int i = 0; i < 8; ++i) deposits[static_cast<std::size_t>(i)].rho = 1e-9;
    const LightPathForecast forecast(deposits, kFrame, measure);
    CHECK(forecast.variance(0, {}) == doctest::Approx(usual));
    CHECK(forecast.fireflies() == doctest::Approx(usual));
    for (int i = 0; i < 100; ++i) deposits[static_cast<std::size_t>(i)].rho = 1e-4; // these are many
    CHECK(LightPathForecast(deposits, kFrame, measure).variance(0, {}) > 50 * usual);
}

// Common light that a look has seen, and a caustic that it has not.
TEST_CASE("light path forecast: what a look has missed is the brightest") {
    const RouletteReference unknown;
    std::vector<LightDeposit> deposits = even(1, 1);
    for (const LightDeposit& d : even(1, 1e-3)) deposits.push_back(d);
    const NoiseMeasure measure(kFrame, unknown, deposits);
    const LightPathForecast forecast(deposits, kFrame, measure);
    const double weight = 1 / (4 * 1.01);
    CameraNoise seen;
    seen.alone.all = seen.alone.quiet = {weight, 0}; // without noise
    CHECK(forecast.variance(0, seen) == doctest::Approx(weight * 1000).epsilon(1e-3));
    CHECK(forecast.variance(1, seen) == doctest::Approx(weight * (1 / 1.001 + 1.0 / 4)).epsilon(1e-3));
}

// One firefly that a look happens to meet says nothing of how noisy common light is, and nothing of the rest.
TEST_CASE("light path forecast: a firefly that a look has seen is no noise that light paths leave") {
    const RouletteReference unknown;
    std::vector<LightDeposit> deposits = even(1, 20); // what every camera path finds
    for (const LightDeposit& d : even(1, 1e-3)) deposits.push_back(d);
    const NoiseMeasure measure(kFrame, unknown, deposits);
    const LightPathForecast forecast(deposits, kFrame, measure);
    const double weight = 1 / (4 * 1.01);
    CameraNoise seen;
    seen.alone.quiet = {weight / 20, 0};
    for (const double met : {0.0, 10.0, 1e5}) { // its second moment and variance
        CAPTURE(met);
        seen.alone.all = {weight / 20 + met, met};
        CHECK(forecast.variance(1, seen) < weight * (1.1 + met * 1e-5));
    }
}

// Light that next-event estimation finds is most of what unaimed paths bring, and none of the noise.
TEST_CASE("emission learning: what camera paths find without noise draws no light paths") {
    EmissionPlan plan;
    plan.targets = {{{0, 0, 5}, 1}};
    const RouletteReference unknown;
    std::vector<LightStart> starts;
    std::vector<LightDeposit> deposits = even(1, 20, 8192);
    for (std::size_t i = 0; i < deposits.size(); ++i) {
        LightDeposit& d = deposits[i];
        d.start = {0, i % 2 == 0 ? 1u : 0u, 0};
        starts.push_back(d.start);
        if (i % 2 == 0) d.rho = 1e-3, d.luminance = 0.01;
    }
    const NoiseMeasure measure(kFrame, unknown, deposits);
    const auto unaimed = [&](bool alone) {
        return static_cast<double>(learnEmission(plan, 1, starts, deposits, measure, alone).uniformShare);
    };
    CHECK(unaimed(false) < 0.1);
    CHECK(unaimed(true) > 0.5); // nobody else has it
}

TEST_CASE("emission learning: paths go where light came from, and some everywhere") {
    EmissionPlan plan;
    plan.targets = {{{0, 0, 5}, 1}, {{5, 0, 0}, 1}};
    const RouletteReference unknown;
    std::vector<LightStart> starts;
    std::vector<LightDeposit> deposits;
    Random random(3);
    for (std::uint32_t i = 0; i < 9000; ++i) {
        const LightStart start{0, i % 3, i % 3 == 0 ? 0 : static_cast<std::uint32_t>(random.uniform() * 256)};
        starts.push_back(start);
        if (start.target != 1 || start.part % 16 >= 8 || start.part / 16 >= 8) continue; // a quarter of one cone
        LightDeposit d;
        d.start = start;
        d.luminance = 1;
        deposits.push_back(d);
    }
    const NoiseMeasure measure(kFrame, unknown, deposits);
    const EmissionPlan learned = learnEmission(plan, 1, starts, deposits, measure, false);
    REQUIRE(learned.parts.size() == 2);
    CHECK(learned.parts[1].empty());
    REQUIRE(learned.parts[0].size() == 256);
    double inside = 0, least = 1;
    for (std::size_t i = 0; i < 256; ++i) {
        if (i % 16 < 8 && i / 16 < 8) inside += learned.parts[0][i];
        least = std::min(least, learned.parts[0][i]);
    }
    const double all = std::accumulate(learned.parts[0].begin(), learned.parts[0].end(), 0.0);
    CHECK(inside / all > 0.75);
    CHECK(least / all * 256 > 0.09);
    CHECK(learned.aim[0] > 10 * learned.aim[1]);
    CHECK(learned.aim[1] > 0);
    CHECK(static_cast<double>(learned.uniformShare) == doctest::Approx(0.05)); // nothing came without aim
    starts.resize(20);                                                         // too few to tell
    CHECK(learnEmission(plan, 1, starts, deposits, measure, false).parts[0].empty());
}

TEST_CASE("pilot pixels: an even grid of different pixels") {
    const PilotPixel::Grid grid({-3, 2, 7, 5}, 4); // 10 × 3
    REQUIRE(grid.size() == 12);
    CHECK(grid.pixel(0).x0 == -2);
    CHECK(grid.pixel(0).y0 == 2);
    CHECK(grid.pixel(11).x0 == 5);
    CHECK(grid.pixel(11).y0 == 4);
    CHECK(grid.pixel(11).area() == 1);
}

} // namespace abbe::test

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
    REQUIRE(twice.size() == 2); // a light that is placed twice
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

// Noise that light paths hardly ever show, such as what a dull mirror sees in itself: deposits do not tell of it.
TEST_CASE("light path forecast: noise that a look has seen beside light paths stays") {
    const RouletteReference unknown;
    const std::vector<LightDeposit> deposits = even(1, 1);
    const NoiseMeasure measure(kFrame, unknown, deposits);
    const LightPathForecast forecast(deposits, kFrame, measure);
    const double ofLight = 1 / 1.01 / 4; // with one light path for each camera path
    CameraNoise seen;
    seen.alone.all = seen.alone.quiet = {10, 8};
    CHECK(forecast.variance(0, seen) == doctest::Approx(8));
    CHECK(forecast.variance(1, seen) == doctest::Approx(8 * 0.25 + ofLight));
    seen.beside.all = seen.beside.quiet = {9, 7.2};
    seen.besideShare = 1;
    CHECK(forecast.variance(0, seen) == doctest::Approx(8));
    CHECK(forecast.variance(1, seen) == doctest::Approx(7.2 + ofLight));
    const double more = forecast.variance(3, seen) - 3 / 1.01 / 16;
    CHECK(more == doctest::Approx(8 * 0.9 * 0.9)); // deposits: a sixteenth in place of a quarter
    // What only fireflies have been seen to lose is not lost by the rest.
    seen.beside.quiet = seen.alone.quiet;
    seen.beside.all = seen.beside.quiet;
    seen.alone.all = {30, 28};
    CHECK(forecast.variance(1, seen) == doctest::Approx(8 + ofLight));
}

} // namespace abbe::test
