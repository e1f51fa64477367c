#include "support/cpu_time.h"
#include "unit/volumes/voxel_cases.h"
#include "volumes/brick_walk.h"

#include <doctest/doctest.h>
#include <type_traits>

using namespace abbe;
using namespace abbe::test;

static_assert(std::is_trivially_destructible_v<BrickWalk>);
static_assert(sizeof(BrickWalk) <= 320);

namespace {

struct TestRay {
    Vec3d origin, direction;
    float t0 = 0, t1 = kInfinity;
};

std::vector<BrickSegment> segments(const BrickBounds& bounds, const TestRay& r, float extinction = kInfinity) {
    std::vector<BrickSegment> result;
    BrickWalk walk(bounds, r.origin, r.direction, r.t0, r.t1, extinction);
    BrickSegment s;
    while (walk.next(s)) {
        result.push_back(s);
        REQUIRE(result.size() < 100'000);
    }
    CHECK_FALSE(walk.next(s));
    return result;
}

// In order, without overlap, and right at random points: the field is within the segment's bounds, and 0 elsewhere.
void checkWalk(const VoxelGrid& grid, const BrickBounds& bounds, const TestRay& r, std::mt19937& random,
               float extinction = kInfinity) {
    const auto list = segments(bounds, r, extinction);
    float last = r.t0;
    for (const BrickSegment& s : list) {
        REQUIRE(s.tNear >= last);
        REQUIRE(s.tFar > s.tNear);
        REQUIRE(s.tFar <= r.t1);
        REQUIRE(s.minimum <= s.mean);
        REQUIRE(s.mean <= s.maximum);
        last = s.tFar;
    }
    VoxelGrid::Sampler sampler = grid.sampler();
    const auto at = [&](float t) { return sampler.at(Vec3(r.origin + r.direction * double(t))); };
    std::uniform_real_distribution<float> unit(0.f, 1.f);
    float gap = r.t0;
    const float end = std::min(r.t1, list.empty() ? 1000.f : list.back().tFar + 50);
    for (std::size_t i = 0; i <= list.size(); ++i) {
        const float gapEnd = i < list.size() ? list[i].tNear : end;
        for (int k = 0; k < 6 && gap < gapEnd; ++k) // rounding of points may touch what lies beside the gap
            REQUIRE(at(lerp(gap, gapEnd, unit(random))) < 2e-2f);
        if (i == list.size()) break;
        for (int k = 0; k < 6; ++k) {
            const float value = at(lerp(list[i].tNear, list[i].tFar, unit(random)));
            REQUIRE(value >= list[i].minimum);
            REQUIRE(value <= list[i].maximum);
        }
        gap = list[i].tFar;
    }
}

struct Scene {
    VoxelGrid grid;
    BrickBounds bounds;
    explicit Scene(std::span<const Voxel> voxels)
        : grid(makeVoxelGrid(voxels, facts())), bounds(BrickBounds::build(grid)) {}
};

TestRay randomRay(std::mt19937& random, double size) {
    std::uniform_real_distribution<double> place(-0.3 * size, 1.3 * size), unit(-1, 1);
    const Vec3d from(place(random), place(random), place(random)), to(place(random), place(random), place(random));
    return {from, (to - from) * std::exp2(unit(random) * 4)};
}

} // namespace

TEST_CASE("random walks agree with sampling") {
    std::mt19937 random(11);
    auto voxels = randomVoxels(12, 150, 3000, {-20, -30, -40});
    const auto solid = block({0, 0, 0}, {90, 90, 90}, 0.25f);
    voxels.insert(voxels.end(), solid.begin(), solid.end());
    const Scene s(voxels);
    for (int i = 0; i < 3000; ++i) checkWalk(s.grid, s.bounds, randomRay(random, 150), random);
    for (int i = 0; i < 1000; ++i) {
        TestRay r = randomRay(random, 150);
        r.t0 = 0.2f;
        r.t1 = 0.7f;
        checkWalk(s.grid, s.bounds, r, random, 0.1f);
    }
}

TEST_CASE("rays along axes, diagonals, planes between bricks and through corners") {
    std::mt19937 random(21);
    const Scene s(randomVoxels(22, 64, 30'000, {-32, -32, -32}));
    const double places[] = {-40, -32, -8, 0, 1e-9, -1e-9, 0.5, 7.999999, 8, 31.5, 32, 40};
    for (const double a : places)
        for (const double b : places)
            for (const double sign : {1.0, -1.0}) {
                checkWalk(s.grid, s.bounds, {{-100 * sign, a, b}, {sign, 0, 0}}, random);
                checkWalk(s.grid, s.bounds, {{a, -100 * sign, b}, {0, sign, 0}}, random);
                checkWalk(s.grid, s.bounds, {{a, b, -100 * sign}, {0, 0, sign}}, random);
                checkWalk(s.grid, s.bounds, {{a - 64, b - 64, -64}, {sign, sign, 1}}, random);
                checkWalk(s.grid, s.bounds, {{a, b, -64 * sign}, {1e-30, -1e-12, sign}}, random);
                checkWalk(s.grid, s.bounds, {{a, b, 0}, {1e-300, 1e-310, sign}}, random);
                checkWalk(s.grid, s.bounds, {{a, b, 0}, {0, 0, 0}, 0, 5}, random);
            }
}

TEST_CASE("in a full box segments follow without gaps and fill it") {
    const Scene s(block({-40, -40, -40}, {80, 80, 80}, 2.f));
    std::mt19937 random(31);
    std::uniform_real_distribution<double> inside(-30, 70);
    for (int i = 0; i < 2000; ++i) {
        const Vec3d a(inside(random), inside(random), inside(random)),
            b(inside(random), inside(random), inside(random));
        const auto list = segments(s.bounds, {a, b - a, 0, 1});
        REQUIRE(!list.empty());
        CHECK(list.front().tNear == 0.f);
        CHECK(list.back().tFar == 1.f);
        for (std::size_t k = 1; k < list.size(); ++k) REQUIRE(list[k].tNear == list[k - 1].tFar);
    }
    // From outside: the support is [-41, 80]; its bricks begin at -48 and end at 80.
    const auto list = segments(s.bounds, {{-100, 3, 3}, {1, 0, 0}});
    CHECK(list.front().tNear == doctest::Approx(52));
    CHECK(list.back().tFar == doctest::Approx(180));
}

TEST_CASE("rays that meet nothing, or are none, have no segments" * doctest::test_suite("input")) {
    const Scene s(block({0, 0, 0}, {10, 10, 10}, 1));
    const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    CHECK(segments(s.bounds, {{-50, 40, 3}, {1, 0, 0}}).empty());
    CHECK(segments(s.bounds, {{-50, 3, 3}, {-1, 0, 0}}).empty());
    CHECK(segments(s.bounds, {{-50, 3, 3}, {1, 0, 0}, 0, 20}).empty());
    CHECK(segments(s.bounds, {{-50, 3, 3}, {1, 0, 0}, 100, 200}).empty());
    CHECK(segments(s.bounds, {{5, 5, 5}, {1, 0, 0}, 3, 3}).empty());
    CHECK(segments(s.bounds, {{5, 5, 5}, {1, 0, 0}, 3, 2}).empty());
    for (const double bad : {nan, inf, -inf}) {
        CHECK(segments(s.bounds, {{bad, 5, 5}, {1, 0, 0}}).empty());
        CHECK(segments(s.bounds, {{5, 5, 5}, {1, bad, 0}}).empty());
    }
    CHECK(segments(s.bounds, {{1e300, 5, 5}, {-1, 1e-300, 0}}).empty());
    CHECK(segments(BrickBounds(), {{5, 5, 5}, {1, 0, 0}}).empty());
    const auto still = segments(s.bounds, {{5, 5, 5}, {0, 0, 0}});
    REQUIRE(still.size() == 1);
    CHECK(still[0].tFar == kInfinity);
}

TEST_CASE("single and far-apart voxels are found" * doctest::test_suite("input")) {
    const Scene one(std::vector<Voxel>{{{3, 3, 3}, 1}});
    CHECK(segments(one.bounds, {{-1e5, 3, 3}, {1, 0, 0}}).size() == 1);
    const Scene apart(std::vector<Voxel>{{{0, 0, 0}, 1}, {{1'000'000, 0, 0}, 2}, {{-5, 1'000'000, -1'000'000}, 3}});
    auto list = segments(apart.bounds, {{-10, 0.25, 0.25}, {1, 0, 0}});
    REQUIRE(list.size() == 4); // voxels at 0 and 1e6 lie on borders of bricks
    CHECK(list.front().tNear == doctest::Approx(2));
    CHECK(list.back().tFar == doctest::Approx(1'000'018));
    list = segments(apart.bounds, {{1'000'000.0 + 1e-3, 1e6, -1e6}, {-1, 1, -1}});
    CHECK(list.empty());
    list = segments(apart.bounds, {{995, 999'000, -999'000}, {-1, 1, -1}});
    REQUIRE(!list.empty());
    CHECK(list.back().maximum >= 3);
}

TEST_CASE("a coarse walk has fewer steps, and segments thin enough") {
    const Scene s(randomVoxels(41, 400, 400'000));
    std::mt19937 random(42);
    std::size_t fine = 0, coarse = 0;
    for (int i = 0; i < 300; ++i) {
        const TestRay r = randomRay(random, 400);
        const float extinction = 0.5f * static_cast<float>(length(r.direction));
        fine += segments(s.bounds, r).size();
        const auto list = segments(s.bounds, r, extinction * 1e-3f);
        coarse += list.size();
        for (const BrickSegment& g : list) REQUIRE(g.maximum * extinction * 1e-3f * (g.tFar - g.tNear) <= 0.2501f);
        checkWalk(s.grid, s.bounds, r, random, extinction);
    }
    CHECK(coarse * 4 < fine);
}

TEST_CASE("steps per second") {
    const Scene s(randomVoxels(51, 200, 600'000));
    std::mt19937 random(52);
    std::vector<TestRay> rays;
    for (int i = 0; i < 20'000; ++i) rays.push_back(randomRay(random, 200));
    std::uint64_t steps = 0;
    float sum = 0;
    const double seconds = cpuSecondsOf([&] {
        for (const TestRay& r : rays) {
            BrickWalk walk(s.bounds, r.origin, r.direction, r.t0, r.t1);
            BrickSegment g;
            for (; walk.next(g); ++steps) sum += g.maximum;
        }
    });
    const double rate = double(steps) / seconds;
    MESSAGE((rate / 1e6) << " million steps a second");
    CHECK(sum > 0);
    CHECK(rate > 1e6);
}
