// Objects that move while the shutter is open: at each time they are where they would stand still.
#include "geometry/embree_scene_builder.h"
#include "geometry/mesh.h"
#include "math/warp.h"
#include "support/statistics.h"
#include "unit/geometry/test_meshes.h"

#include <doctest/doctest.h>

using namespace abbe;
using namespace abbe::test;

namespace {

using Key = KeyedTransform::Key;

TransformStep turn(Vec3d axis, double degrees) { return {TransformStep::Kind::rotate, axis, degrees * kPiD / 180, {}}; }
TransformStep move(Vec3d by) { return {TransformStep::Kind::translate, by, 0, {}}; }
TransformStep scale(Vec3d by) { return {TransformStep::Kind::scale, by, 0, {}}; }
TransformStep matrix(const Transform& t) { return {TransformStep::Kind::matrix, {}, 0, t}; }

// A long thin box-like blade: an icosphere stretched.
MeshData blade() {
    MeshData m = icosphere(2, {}, 1);
    for (Vec3& p : m.positions) p = {3 * p.x + 3, 0.2f * p.y, 0.2f * p.z};
    return m;
}

constexpr int kCopies = 50;
Transform offset(int k) { return Transform::translate({0, 0, 30.0 * k}); }

struct MovingComparison {
    int hits = 0, differing = 0;
    double worst = 0;
};

// Rays at random times against scenes in which the object stands where it is at that time.
MovingComparison compare(const Motion& motion, double open, double duration) {
    const Mesh mesh(blade());
    EmbreeSceneBuilder moving;
    moving.setShutter(open, duration);
    // Several, so that there are boxes to pass before the objects: a lone one is its tree's root.
    const std::uint32_t object = moving.addObject({{&mesh, {}}});
    for (int k = 0; k < kCopies; ++k) moving.addMoving(object, motion.then(offset(k)));
    const auto scene = moving.build();
    Random random(11);
    MovingComparison result;
    for (int t = 0; t <= 40; ++t) {
        const float time = t == 40 ? 1.f : random.uniform();
        EmbreeSceneBuilder still;
        const Transform place = motion.at(open + static_cast<double>(time) * duration);
        const std::uint32_t copy = still.addObject({{&mesh, {}}});
        for (int k = 0; k < kCopies; ++k) still.addInstance(copy, place.then(offset(k)));
        const auto expected = still.build();
        for (int i = 0; i < 500; ++i) {
            const Vec3d onBlade{6 * random.uniformDouble(), 0.3 * random.uniformDouble() - 0.15, 0};
            const Vec3 target(place.then(offset(i % kCopies)).point(onBlade));
            const Vec3 direction = squareToSphere({random.uniform(), random.uniform()});
            const Ray ray{target - direction * 20, direction, kInfinity, time};
            SurfaceHit a, b;
            const bool ma = scene->intersect(ray, a), mb = expected->intersect(ray, b);
            result.differing += ma != mb || scene->occluded(ray) != mb;
            if (!ma || !mb) continue;
            ++result.hits;
            result.worst = std::max(
                {result.worst, static_cast<double>(length(a.p - b.p)), static_cast<double>(length(a.ng - b.ng))});
        }
    }
    return result;
}

void check(const MovingComparison& c) {
    CHECK(c.hits > 10'000);
    CHECK(c.differing <= 2); // a ray along an edge may fall to either side
    CHECK(c.worst < 1e-3);
}

} // namespace

TEST_CASE("motion: a blade turning by 170°, and by two full turns") {
    check(compare(
        Motion().then(KeyedTransform(std::vector<Key>{{0, {turn({0, 0, 1}, 0)}}, {1, {turn({0, 0, 1}, 170)}}})), 0, 1));
    check(compare(
        Motion().then(KeyedTransform(std::vector<Key>{{0, {turn({0, 1, 0}, 0)}}, {1, {turn({0, 1, 0}, 720)}}})), 0, 1));
}

TEST_CASE("motion: taken apart between matrices, several keys with kinks, part of the time only") {
    const Transform a = Transform::scale({1, 2, 1}).then(Transform::rotate({1, 1, 0}, 1));
    const Transform b =
        Transform::scale({2, 1, -1}).then(Transform::rotate({0, 1, 3}, -2)).then(Transform::translate({5, 0, 1}));
    check(compare(Motion().then(KeyedTransform(
                      std::vector<Key>{{0, {matrix(a)}}, {1, {matrix(Transform::translate({0, 4, 0}))}}})),
                  0, 1));
    check(compare(
        Motion().then(KeyedTransform(std::vector<Key>{
            {2, {move({0, 0, 0})}}, {2.13, {move({9, 1, 0})}}, {2.2, {move({-4, 0, 7})}}, {2.9, {move({0, -20, 0})}}})),
        2.05, 0.5));
    CHECK(b.determinant() < 0);
}

TEST_CASE("motion: a group that moves around an object that moves and grows") {
    const KeyedTransform grow(std::vector<Key>{{0, {scale({1, 1, 1})}}, {1, {scale({1, 3, 2})}}});
    const KeyedTransform orbit(std::vector<Key>{{0, {turn({0, 1, 0}, 0)}}, {1, {turn({0, 1, 0}, 360)}}});
    check(compare(Motion().then(grow).then(Transform::translate({10, 0, 0})).then(orbit), 0, 1));
}

TEST_CASE("motion: times outside the shutter and NaN are refused, not passed to Embree" *
          doctest::test_suite("input")) {
    const Mesh mesh(blade());
    EmbreeSceneBuilder builder;
    builder.setShutter(0, 1);
    builder.addMoving(builder.addObject({{&mesh, {}}}),
                      Motion().then(KeyedTransform(std::vector<Key>{{0, {move({0, 0, 0})}}, {1, {move({1, 0, 0})}}})));
    const auto scene = builder.build();
    SurfaceHit hit;
    for (const float time : {-0.1f, 1.5f, std::numeric_limits<float>::quiet_NaN()}) {
        CHECK_FALSE(scene->intersect({{3, 0, 5}, {0, 0, -1}, kInfinity, time}, hit));
        CHECK_FALSE(scene->occluded({{3, 0, 5}, {0, 0, -1}, kInfinity, time}));
    }
    CHECK(scene->rejectedRays() == 6);
}
