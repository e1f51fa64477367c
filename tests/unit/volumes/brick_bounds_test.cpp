#include "unit/volumes/voxel_cases.h"
#include "volumes/brick_bounds.h"

#include <doctest/doctest.h>

using namespace abbe;
using namespace abbe::test;

namespace {

bool holds(const FieldBounds& b, float value) { return b.minimum <= value && value <= b.maximum; }

} // namespace

TEST_CASE("the interpolated field stays within the bounds of its brick, and comes near them") {
    for (const std::uint32_t seed : {1u, 2u, 3u}) {
        auto voxels = randomVoxels(seed, 60, seed == 1 ? 150'000 : 3000, {-31, -5, 70});
        const auto solid = block({-10, 0, 80}, {14, 24, 104}, 0.5f);
        voxels.insert(voxels.end(), solid.begin(), solid.end());
        const VoxelGrid grid = makeVoxelGrid(voxels, facts());
        const BrickBounds bounds = BrickBounds::build(grid);
        VoxelGrid::Sampler sampler = grid.sampler();
        std::mt19937 random(seed);
        std::uniform_real_distribution<float> within(0.f, 1.f);
        for (int i = 0; i < 400'000; ++i) {
            const Vec3 p(-34 + 68 * within(random), -8 + 68 * within(random), 66 + 68 * within(random));
            const float value = sampler.at(p);
            REQUIRE(holds(bounds.at(p), value));
            if (bounds.at(p).maximum == 0) continue;
            // also a little beside the brick, where rounding may put a point of a walk
            const Vec3 q = p + Vec3(0.03f, -0.03f, 0.03f) * (within(random) * 2 - 1);
            REQUIRE(holds(bounds.at(p), sampler.at(q)));
        }
        // A voxel's own value is reached in the brick that it lies in.
        for (int i = 0; i < 2000; ++i) {
            const Vec3i v = voxels[random() % voxels.size()].place;
            REQUIRE(holds(bounds.at(Vec3(v)), sampler.voxel(v)));
        }
    }
}

TEST_CASE("the mean of a brick is the mean of its field; a constant brick is exact") {
    const VoxelGrid grid = makeVoxelGrid(randomVoxels(5, 40, 20'000), facts());
    const BrickBounds bounds = BrickBounds::build(grid);
    VoxelGrid::Sampler sampler = grid.sampler();
    for (const Vec3i brick : {Vec3i(0, 0, 0), Vec3i(2, 1, 3), Vec3i(4, 4, 4)}) {
        double sum = 0;
        const int n = 32; // midpoints of an even subdivision of every cell: exact for multilinear fields
        for (int x = 0; x < n; ++x)
            for (int y = 0; y < n; ++y)
                for (int z = 0; z < n; ++z) {
                    const Vec3 p =
                        Vec3(brick) * 8 + Vec3(float(x) + 0.5f, float(y) + 0.5f, float(z) + 0.5f) * (8.f / n);
                    sum += double(sampler.at(p));
                }
        CHECK(double(bounds.at(Vec3(brick) * 8).mean) == doctest::Approx(sum / (n * n * n)).epsilon(1e-5));
    }
    const BrickBounds solid = BrickBounds::build(makeVoxelGrid(block({0, 0, 0}, {40, 40, 40}, 0.3f), facts()));
    const FieldBounds inner = solid.at({20, 20, 20});
    CHECK(inner.minimum == 0.3f);
    CHECK(inner.mean == 0.3f);
    CHECK(inner.maximum == 0.3f);
}

TEST_CASE("dilated bounds hold as far away as was asked for") {
    const VoxelGrid grid = makeVoxelGrid(randomVoxels(7, 50, 500), facts());
    const float reach = 11;
    const BrickBounds bounds = BrickBounds::build(grid, reach);
    VoxelGrid::Sampler sampler = grid.sampler();
    std::mt19937 random(8);
    std::uniform_real_distribution<float> place(-20.f, 70.f), step(-reach, reach);
    for (int i = 0; i < 100'000; ++i) {
        const Vec3 p(place(random), place(random), place(random));
        const Vec3 q = p + Vec3(step(random), step(random), step(random));
        REQUIRE(holds(bounds.at(p), sampler.at(q)));
    }
}

TEST_CASE("finer bricks hold what is in them, are tighter, and have the means of their cells") {
    const VoxelGrid grid = makeVoxelGrid(randomVoxels(11, 50, 60'000, {-31, -5, 70}), facts());
    const BrickBounds whole = BrickBounds::build(grid);
    VoxelGrid::Sampler sampler = grid.sampler();
    for (const int halvings : {1, 2}) {
        const float scale = static_cast<float>(1 << halvings), reach = halvings == 1 ? 0 : 5.f;
        const BrickBounds bounds = BrickBounds::build(grid, reach, halvings),
                          tight = BrickBounds::build(grid, 0, halvings);
        CHECK(tight.brickCount() > 4 * whole.brickCount());
        std::mt19937 random(12);
        std::uniform_real_distribution<float> within(0.f, 1.f), step(-reach, reach), beside(-0.03f, 0.03f);
        for (int i = 0; i < 200'000; ++i) {
            const Vec3 p(-34 + 60 * within(random), -8 + 60 * within(random), 66 + 60 * within(random));
            REQUIRE(holds(tight.at(p * scale), sampler.at(p)));
            if (tight.at(p * scale).maximum == 0) continue;
            REQUIRE(holds(whole.at(p), tight.at(p * scale).minimum));
            REQUIRE(holds(whole.at(p), tight.at(p * scale).maximum));
            const float away = reach > 0 ? step(random) : beside(random);
            REQUIRE(holds(bounds.at(p * scale), sampler.at(p + Vec3(away, -away, away))));
        }
        const int n = 8 >> halvings;
        for (const Vec3i cell : {Vec3i(0, 0, 80), Vec3i(-16, 12, 92), Vec3i(4, 20, 100)}) {
            double sum = 0;
            for (int i = 0; i < 8 * n * n * n; ++i)
                sum +=
                    double(sampler.at(Vec3(cell) + (Vec3(Vec3i(i / (4 * n * n), i / (2 * n) % (2 * n), i % (2 * n))) +
                                                    Vec3(0.5f, 0.5f, 0.5f)) *
                                                       0.5f));
            CHECK(double(tight.at((Vec3(cell) + Vec3(1, 1, 1)) * scale).mean) ==
                  doctest::Approx(sum / (8 * n * n * n)).epsilon(1e-4));
        }
    }
}

TEST_CASE("a constant region is one node, however large") {
    const VoxelGrid grid = makeVoxelGrid(block({0, 0, 0}, {200, 200, 200}, 1.f), facts());
    const BrickBounds bounds = BrickBounds::build(grid);
    CHECK(bounds.brickCount() == 26 * 26 * 26 - 8 * 512); // eight nodes of 64 voxels lie inside
    CHECK(bounds.at({100, 100, 100}).minimum == 1.f);
    CHECK(bounds.maximum() >= 1.f);
    CHECK(bounds.maximum() < 1.00001f);
}

TEST_CASE("empty, single and far-apart voxels" * doctest::test_suite("input")) {
    CHECK(BrickBounds::build(makeVoxelGrid({}, facts())).empty());
    CHECK(BrickBounds::build(makeVoxelGrid(block({0, 0, 0}, {9, 9, 9}, 0.f), facts())).empty());
    const std::vector<Voxel> corner{{{8, 8, 8}, 1}}; // reaches into eight bricks
    CHECK(BrickBounds::build(makeVoxelGrid(corner, facts())).brickCount() == 8);
    const std::vector<Voxel> apart{{{0, 0, 0}, 1}, {{1'000'000, 0, 0}, 2}, {{-5, 1'000'000, -1'000'000}, 3}};
    const VoxelGrid grid = makeVoxelGrid(apart, facts());
    const BrickBounds bounds = BrickBounds::build(grid);
    CHECK(bounds.bytes() < 100'000);
    CHECK(bounds.bytes() + grid.bytes() < 10'000'000);
    CHECK(bounds.maximum() >= 3);
    CHECK(bounds.at({1e6f, 0, 0}).maximum >= 2);
    CHECK(bounds.at({5e5f, 0, 0}).maximum == 0);
    CHECK(bounds.at({kInfinity, 0, 0}).maximum == 0);
}

TEST_CASE("bounds are small beside the grid") {
    const VoxelGrid grid = makeVoxelGrid(randomVoxels(9, 100, 400'000), facts());
    CHECK(BrickBounds::build(grid).bytes() * 20 < grid.bytes());
}
