// Volumes that drift while the shutter is open, and the colour of their voxels.
#include "media/grid_medium.h"
#include "support/made_grids.h"
#include "support/media.h"
#include "support/statistics.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

const ConstantCurve kOne(1), kHalf(0.5);

MediumOptics motionOptics() { return opticsOf(kOne, kHalf); }

const Transform kPlace = Transform::scale({0.1, 0.1, 0.1}).then(Transform::rotate({0, 0, 1}, 0.4));
const Transform kCoarse = Transform::scale({0.4, 0.4, 0.4}).then(Transform::translate({0.1, 0, 0}));
const Transform kMotionWorld =
    Transform::scale({2, 2, 2}).then(Transform::rotate({1, 1, 0}, 1)).then(Transform::translate({1, 2, 3}));

VoxelGrid speckles(std::uint64_t seed) {
    Random random(seed);
    std::vector<Voxel> voxels;
    for (int i = 0; i < 1000; ++i) voxels.push_back({{i % 10 - 5, i / 10 % 10 - 5, i / 100 - 5}, 1});
    const auto place = [&] { return static_cast<int>(random.uniform() * 40) - 20; };
    for (int i = 0; i < 300; ++i) voxels.push_back({{place(), place(), place()}, 1 + random.uniform()});
    return makeVoxelGrid(voxels, fogAt(kPlace));
}

VectorGrid winds(float fastest) {
    Random random(5);
    std::vector<VectorVoxel> voxels;
    const auto gust = [&] { return 0.2f * (random.uniform() - 0.5f); };
    for (int z = -18; z <= 18; ++z)
        for (int y = -18; y <= 18; ++y)
            for (int x = -18; x <= 18; ++x) voxels.push_back({{x, y, z}, Vec3(gust(), gust(), 1 + gust()) * fastest});
    return makeVectorGrid(voxels, fogAt(kCoarse));
}

GridMedium moving(double first, double duration, double scale = 1) {
    GridExtras extras;
    extras.velocity = GridVelocity{winds(1), scale, first, duration};
    return GridMedium(motionOptics(), speckles(3), 1, kMotionWorld, std::move(extras));
}

} // namespace

TEST_CASE("a drifting volume is where its velocity has carried it, and within its bounds at all times") {
    const GridMedium medium = moving(-0.3, 4);
    const VoxelGrid density = speckles(3);
    const VectorGrid wind = winds(1);
    const Transform toWorld = *kMotionWorld.inverse();
    CHECK(medium.drift() > 30);
    Random random(8);
    int found = 0;
    for (int i = 0; i < 4000; ++i) {
        const float time = i % 3 == 0 ? 0.f : i % 3 == 1 ? 1.f : random.uniform();
        const auto about = [&] { return random.uniform() * 10 - 5; };
        const Vec3 origin = Vec3(1, 2, 3) + Vec3(about(), about(), about());
        const Vec3 target = Vec3(1, 2, 3) + Vec3(about(), about(), about()) * 0.6f;
        if (!(length(target - origin) > 0.1f)) continue;
        const Ray ray{origin, normalize(target - origin), 20, time};
        WalkSpace space;
        MediumWalk* walk = medium.walk(ray, ray.tMax, space);
        MediumSegment s;
        float end = 0;
        const auto want = [&](float t) {
            const Vec3d p = toWorld.point(Vec3d(ray.origin) + Vec3d(ray.direction) * static_cast<double>(t));
            const Vec3d v(wind.sampler().at(Vec3(wind.worldToIndex().point(p))));
            const Vec3d from = p - v * (4 * static_cast<double>(time) - 0.3);
            return density.sampler().at(Vec3(density.worldToIndex().point(from)));
        };
        while (walk->next(s)) {
            for (int k = 0; k < 3; ++k) {
                if (s.tNear > end) REQUIRE(want(end + (s.tNear - end) * random.uniform()) == 0);
                const float t = s.tNear + (s.tFar - s.tNear) * random.uniform(), value = walk->density(t);
                REQUIRE(value <= s.maximum);
                REQUIRE(value >= s.minimum);
                REQUIRE(std::abs(value - want(t)) < 5e-3f);
                found += value > 0;
            }
            end = s.tFar;
        }
        REQUIRE(want(end + random.uniform()) == 0);
    }
    CHECK(found > 1000);
}

TEST_CASE("what does not move costs nothing: the same as without velocity") {
    const GridMedium still(motionOptics(), speckles(3), 1, kMotionWorld);
    for (const GridMedium& medium : {moving(0, 0), moving(0, 1, 0)}) {
        CHECK(medium.drift() == 0);
        WalkSpace a, b;
        const Ray ray{{1, 2, 9}, {0, 0, -1}, 20, 0.7f};
        MediumWalk *one = medium.walk(ray, 20, a), *other = still.walk(ray, 20, b);
        MediumSegment s, t;
        while (one->next(s)) {
            REQUIRE(other->next(t));
            CHECK(s.tNear == t.tNear);
            CHECK(s.maximum == t.maximum);
            CHECK(one->density(s.tNear) == other->density(s.tNear));
        }
        CHECK_FALSE(other->next(t));
    }
    // A closed moment away from that of the file moves things all the same.
    CHECK(moving(0.2, 0).drift() > 0);
}

TEST_CASE("emission drifts along") {
    GridExtras extras;
    extras.velocity = GridVelocity{winds(1), 1, 0, 1};
    extras.glow = Glow::ofSpectrum(kHalf);
    const GridMedium medium(motionOptics(), speckles(3), 1, kMotionWorld, std::move(extras));
    Random random(12);
    int found = 0;
    for (int i = 0; i < 2000; ++i) {
        const auto about = [&] { return random.uniform() * 8 - 4; };
        const Ray ray{Vec3(1, 2, 3) + Vec3(about(), about(), about()), {0, 0, 1}, 5, random.uniform()};
        WalkSpace space, glowSpace;
        MediumWalk* walk = medium.walk(ray, 5, space);
        EmissionWalk* glow = medium.emission()->walk(ray, 5, glowSpace);
        MediumSegment s;
        while (glow->next(s)) {
            const float t = s.tNear + (s.tFar - s.tNear) * random.uniform(), density = walk->density(t);
            CHECK(glow->emitted(t, Wavelengths::single(550))[0] == doctest::Approx(0.5f * density));
            // wherever it emits its light can have made a sample
            const Vec3 p = ray.origin + ray.direction * t;
            if (density > 1e-3f) CHECK(medium.emission()->pdfSolidAngle({0, 0, 0}, p) > 0);
            found += density > 0;
        }
    }
    CHECK(found > 200);
}

TEST_CASE("colour is a factor of the albedo, smooth between voxels") {
    GridExtras extras;
    const std::vector<VectorVoxel> voxels{
        {{0, 0, 0}, {0.8f, 0.8f, 0.8f}}, {{1, 0, 0}, {0.9f, 0.1f, 0.1f}}, {{2, 0, 0}, {2, 2, 2}}};
    const VectorGrid colors = makeVectorGrid(voxels, fogAt({}));
    CHECK(countOutside(colors, 0, 1) == 1);
    extras.color = GridExtras::Color{makeVectorGrid(voxels, fogAt({})),
                                     std::make_unique<UpsamplingTable>(UpsamplingTable::build(rgb::rec709, 16))};
    const std::vector<Voxel> dense{{{0, 0, 0}, 1}, {{1, 0, 0}, 1}, {{2, 0, 0}, 1}};
    const GridMedium medium(motionOptics(), makeVoxelGrid(dense, fogAt({})), 1, {}, std::move(extras));
    CHECK(medium.albedoVaries());
    CHECK_FALSE(GridMedium(motionOptics(), speckles(3), 1, {}).albedoVaries());
    WalkSpace space;
    MediumWalk* walk = medium.walk({{-4, 0, 0}, {1, 0, 0}, 10, 0}, 10, space);
    const auto at = [&](float x, float nm) {
        return static_cast<double>(walk->albedo(4 + x, Wavelengths::single(nm))[0]);
    };
    CHECK(at(0, 450) == doctest::Approx(0.4).epsilon(0.01));
    CHECK(at(0, 650) == doctest::Approx(0.4).epsilon(0.01));
    CHECK(at(1, 650) > 0.4);
    CHECK(at(1, 500) < 0.07);
    CHECK(at(0.5f, 500) > at(1, 500));
    CHECK(at(0.5f, 500) < at(0, 500));
    CHECK(at(2, 500) == doctest::Approx(0.5)); // 2 counts as 1
}

} // namespace abbe::test
