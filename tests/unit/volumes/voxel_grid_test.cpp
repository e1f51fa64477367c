#include "unit/volumes/voxel_cases.h"
#include "volumes/voxel_grid.h"

#include <cstring>
#include <doctest/doctest.h>
#include <map>
#include <tuple>

using namespace abbe;
using namespace abbe::test;

namespace {

using Key = std::tuple<int, int, int>;

// Trilinear interpolation by its definition, in double.
double reference(const std::map<Key, float>& values, Vec3 p) {
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        double weight = 1;
        int c[3];
        for (int a = 0; a < 3; ++a) {
            const double low = std::floor(double(p[a])), f = double(p[a]) - low;
            const int up = corner >> a & 1;
            weight *= up ? f : 1 - f;
            c[a] = static_cast<int>(low) + up;
        }
        const auto found = values.find({c[0], c[1], c[2]});
        if (found != values.end()) sum += weight * double(found->second);
    }
    return sum;
}

GridBytes copyOf(const VoxelGrid& grid) {
    GridBytes bytes(grid.bytes());
    std::memcpy(bytes.data(), &grid.nano(), grid.bytes());
    return bytes;
}

} // namespace

TEST_CASE("the sampler interpolates between voxel centres, across leaves and at negative places" *
          doctest::test_suite("input")) {
    const auto voxels = randomVoxels(1, 40, 9000, {-19, -20, -21});
    std::map<Key, float> values;
    for (const Voxel& v : voxels) values[{v.place.x, v.place.y, v.place.z}] = v.value;
    const VoxelGrid grid = makeVoxelGrid(voxels, facts());
    CHECK(grid.activeVoxels() == values.size());
    VoxelGrid::Sampler sampler = grid.sampler();
    std::mt19937 random(2);
    std::uniform_real_distribution<float> place(-24.f, 24.f);
    for (int i = 0; i < 50'000; ++i) {
        const Vec3 p(place(random), place(random), place(random));
        REQUIRE(double(sampler.at(p)) == doctest::Approx(reference(values, p)).epsilon(1e-5));
    }
    for (const Voxel& v : voxels) REQUIRE(sampler.at(Vec3(v.place)) == values[{v.place.x, v.place.y, v.place.z}]);
}

TEST_CASE("the field is 0 outside, and for points that are none") {
    const VoxelGrid grid = makeVoxelGrid(block({0, 0, 0}, {8, 8, 8}, 0.7f), facts());
    VoxelGrid::Sampler sampler = grid.sampler();
    CHECK(sampler.at({3.3f, 4.7f, 2.9f}) == 0.7f); // constant: exact
    CHECK(sampler.at({7.5f, 3.f, 3.f}) == 0.35f);
    CHECK(sampler.at({8.f, 3.f, 3.f}) == 0.f);
    CHECK(sampler.at({-1.f, 3.f, 3.f}) == 0.f);
    for (const float bad : {1e9f, -1e20f, kInfinity, -kInfinity, std::numeric_limits<float>::quiet_NaN()}) {
        CHECK(sampler.at({bad, 3.f, 3.f}) == 0.f);
        CHECK(sampler.at({3.f, bad, bad}) == 0.f);
    }
    CHECK(grid.lowerVoxel() == Vec3i(0, 0, 0));
    CHECK(grid.upperVoxel() == Vec3i(7, 7, 7));
    CHECK(grid.minimum() == 0.7f);
    CHECK(grid.maximum() == 0.7f);
}

TEST_CASE("world bounds hold the support of a turned grid") {
    GridFacts f = facts();
    f.indexToWorld = Transform::scale({2, 1, 1}).then(Transform::rotate({0, 0, 1}, kPiD / 2));
    const VoxelGrid grid = makeVoxelGrid(block({0, 0, 0}, {4, 2, 1}, 1), f);
    const Bounds3d box = grid.worldBounds();
    CHECK(box.lower.x == doctest::Approx(-2));
    CHECK(box.upper.x == doctest::Approx(1));
    CHECK(box.lower.y == doctest::Approx(-2));
    CHECK(box.upper.y == doctest::Approx(8));
}

TEST_CASE("empty grids are grids" * doctest::test_suite("input")) {
    const VoxelGrid grid = makeVoxelGrid({}, facts());
    CHECK(grid.empty());
    CHECK(grid.support().empty());
    CHECK(grid.worldBounds().empty());
    CHECK(grid.sampler().at({0, 0, 0}) == 0);
}

TEST_CASE("bytes that are no intact grid are not adopted" * doctest::test_suite("input")) {
    const VoxelGrid grid = makeVoxelGrid(randomVoxels(3, 200, 2000), facts());
    CHECK(VoxelGrid::adopt(copyOf(grid), facts()));
    CHECK_FALSE(VectorGrid::adopt(copyOf(grid), facts()));
    GridBytes cut(grid.bytes() / 2);
    std::memcpy(cut.data(), &grid.nano(), cut.size());
    CHECK_FALSE(VoxelGrid::adopt(std::move(cut), facts()));
    CHECK_FALSE(VoxelGrid::adopt(GridBytes(16), facts()));
    // Every byte of the tree's heads, and a child pointer of each internal level: never a crash; what is adopted is
    // read.
    std::mt19937 random(4);
    int refused = 0;
    for (int i = 0; i < 400; ++i) {
        GridBytes bytes = copyOf(grid);
        const std::size_t range = i % 2 ? 2048 : bytes.size();
        bytes.data()[random() % range] ^= static_cast<std::byte>(1 + random() % 255);
        const auto adopted = VoxelGrid::adopt(std::move(bytes), facts());
        if (!adopted) {
            ++refused;
            continue;
        }
        VoxelGrid::Sampler sampler = adopted->sampler();
        float sum = 0;
        for (int k = 0; k < 200; ++k)
            sum += sampler.at(Vec3(float(random() % 256), float(random() % 256), float(random() % 256)));
        CHECK_FALSE(sum == -1);
    }
    CHECK(refused > 5);
}

TEST_CASE("voxels far apart cost nodes, not the space between") {
    const std::vector<Voxel> voxels{{{0, 0, 0}, 1}, {{1'000'000, 0, 0}, 2}, {{-5, 1'000'000, -1'000'000}, 3}};
    const VoxelGrid grid = makeVoxelGrid(voxels, facts());
    CHECK(grid.bytes() < 10'000'000);
    CHECK(grid.sampler().at({1e6f, 0, 0}) == 2);
}
