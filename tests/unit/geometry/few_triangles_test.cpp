// Small scenes without a tree, beside each triangle by itself in double.
#include "geometry/embree_scene_builder.h"
#include "geometry/few_triangles.h"
#include "geometry/flat_shapes.h"
#include "geometry/mesh.h"
#include "geometry/round_shapes.h"
#include "support/numbered_materials.h"
#include "support/statistics.h"
#include "test_meshes.h"

#include <doctest/doctest.h>

using namespace abbe;
using namespace abbe::test;

namespace {

using Triangle = FewTriangles::Triangle;

Vec3 pointInCube(Random& random) {
    return {2 * random.uniform() - 1, 2 * random.uniform() - 1, 2 * random.uniform() - 1};
}

std::vector<Triangle> triangles(std::size_t count, Random& random) {
    std::vector<Triangle> all;
    for (std::uint32_t i = 0; i < count; ++i)
        all.push_back(
            {{pointInCube(random), pointInCube(random), pointInCube(random)}, i, 7 * i, false, kVisibleToAll});
    return all;
}

struct Truth {
    double t = std::numeric_limits<double>::infinity(), u = 0, v = 0;
    std::size_t index = 0;
    bool certain = true; // no ray near it hits anything else
};

// [Moller1997].
Truth nearest(const std::vector<Triangle>& all, const Ray& ray) {
    Truth truth;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Vec3d a(all[i].corners[0]), e1 = Vec3d(all[i].corners[1]) - a, e2 = Vec3d(all[i].corners[2]) - a;
        const Vec3d d(ray.direction), s = Vec3d(ray.origin) - a, p = cross(d, e2), q = cross(s, e1);
        const double f = 1 / dot(e1, p), u = f * dot(s, p), v = f * dot(d, q), t = f * dot(e2, q);
        const double least = std::min({u, v, 1 - u - v});
        if (std::abs(least) < 1e-3) truth.certain = false;
        if (least >= 0 && t > 0 && t < truth.t) {
            if (truth.t - t < 1e-3) truth.certain = false;
            truth = {t, u, v, i, truth.certain};
        } else if (least >= 0 && std::abs(t - truth.t) < 1e-3) {
            truth.certain = false;
        }
    }
    return truth;
}

} // namespace

TEST_CASE("few triangles: the nearest is found, and shadow rays end at any") {
    Random random(3);
    for (const std::size_t count : {1u, 7u, 8u, 9u, 40u, 64u}) {
        const std::vector<Triangle> all = triangles(count, random);
        const auto few = FewTriangles::make(all);
        REQUIRE(few);
        int compared = 0, wrong = 0;
        for (int i = 0; i < 4000; ++i) {
            const Vec3 origin = pointInCube(random) * 2, direction = normalize(pointInCube(random));
            Ray ray{origin, direction};
            const Truth truth = nearest(all, ray);
            if (!truth.certain) continue;
            ++compared;
            const auto found = few->intersect(ray);
            const bool any = truth.t < 1e30;
            wrong += found.has_value() != any || few->occluded(ray) != any;
            if (!found || !any) continue;
            wrong += found->record != truth.index || found->primitive != 7 * truth.index;
            wrong += std::abs(found->t - truth.t) > 1e-5 * truth.t + 1e-6;
            wrong += std::abs(found->u - truth.u) + std::abs(found->v - truth.v) > 1e-3;
            ray.tMax = 0.999f * found->t;
            wrong += few->intersect(ray).has_value() || few->occluded(ray);
            ray.tMax = 1.001f * found->t;
            wrong += !few->intersect(ray) || !few->occluded(ray);
        }
        CAPTURE(count);
        CHECK(compared > 1000);
        CHECK(wrong == 0);
    }
}

TEST_CASE("few triangles: nothing lies along a plane, at the start of a ray, or where it is not seen") {
    const std::array<Vec3, 3> corners{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}};
    const std::vector<Triangle> one{{corners, 0, 0, false, Visibility(RayKind::camera) | RayKind::shadow}};
    const auto few = FewTriangles::make(one);
    REQUIRE(few);
    const Ray down{{0.2f, 0.2f, 1}, {0, 0, -1}, kInfinity, 0, RayKind::camera};
    CHECK(few->intersect(down));
    Ray other = down;
    other.kind = RayKind::shadow;
    CHECK(few->occluded(other));
    other.kind = RayKind::scattered;
    CHECK_FALSE(few->occluded(other));
    CHECK_FALSE(few->intersect(other));
    for (const Vec3 direction : {Vec3{1, 0, 0}, Vec3{0, -1, 0}, normalize(Vec3{1, 2, 0}), Vec3{0, 0, 1}, Vec3()})
        for (const float z : {0.f, 1.f})
            CHECK_FALSE(few->intersect({{0.2f, 0.2f, z}, direction, kInfinity, 0, RayKind::camera}));
    CHECK_FALSE(few->intersect({{0.2f, 0.2f, 0}, {0, 0, -1}, kInfinity, 0, RayKind::camera}));
}

TEST_CASE("few triangles: too many, too small for their distance, moving, or something else is for the tree") {
    Random random(5);
    CHECK_FALSE(FewTriangles::make({}));
    CHECK_FALSE(FewTriangles::make(triangles(FewTriangles::kMost + 1, random)));
    std::vector<Triangle> far = triangles(2, random);
    for (Vec3& p : far[0].corners) p = p * 0.02f + Vec3{1, 1, 1};
    CHECK(FewTriangles::make(far));
    for (Vec3& p : far[1].corners) p = p * 1e3f;
    CHECK_FALSE(FewTriangles::make(far));
    std::vector<Triangle> flat = triangles(2, random);
    flat[0].corners[2] = flat[0].corners[1];
    CHECK(FewTriangles::make(flat));

    const Quad quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
    const Sphere sphere({5, 0, 0}, 1);
    FewTrianglesSink sink;
    CHECK(sink.add(quad, kVisibleToAll));
    const auto few = sink.make();
    REQUIRE(few);
    for (const Vec2 p : {Vec2{-0.6f, 0.2f}, Vec2{0.8f, 0.6f}}) { // in either half
        const auto hit = few->intersect({{p.x, p.y, 1}, {0, 0, -1}});
        REQUIRE(hit);
        CHECK(hit->u == doctest::Approx((p.x + 1) / 2));
        CHECK(hit->v == doctest::Approx((p.y + 1) / 2));
    }
    CHECK_FALSE(sink.add(sphere, kVisibleToAll));
    CHECK_FALSE(sink.make());
}

// The same shapes with and without the tree, which a sphere far away asks for.
TEST_CASE("few triangles: surfaces are those that the tree finds, and a box lets no ray out") {
    const Mesh box(cube({-1, -1, -1}, {1, 1, 1}));
    const Quad bent({-0.5f, -0.6f, 0.1f}, {0.5f, -0.6f, 0.2f}, {0.4f, 0.5f, -0.3f}, {-0.6f, 0.4f, 0.3f});
    const Sphere away({1e4f, 0, 0}, 1e-3);
    const auto build = [&](bool tree) {
        EmbreeSceneBuilder builder;
        builder.addShape(box, {material(1), nullptr});
        builder.addShape(bent, {material(2), nullptr});
        if (tree) builder.addShape(away, {});
        return builder.build();
    };
    const auto with = build(true), without = build(false);
    Random random(9);
    int different = 0, out = 0, again = 0;
    for (int i = 0; i < 20000; ++i) {
        Ray ray{pointInCube(random) * 0.9f, normalize(pointInCube(random))};
        const Vec3 corner{i & 1 ? 1.f : -1.f, i & 2 ? 1.f : -1.f, i & 4 ? 1.f : -1.f};
        const float along = 2 * random.uniform() - 1;
        if (i % 4 == 0) ray.direction = normalize(Vec3{corner.x, corner.y, along} - ray.origin); // at an edge
        if (i % 4 == 1) ray.direction = normalize(corner - ray.origin);
        SurfaceHit a, b;
        const bool hit = without->intersect(ray, a);
        out += !hit;
        if (!hit || !with->intersect(ray, b) || i % 4 < 2) continue;
        different += a.material != b.material || length(a.p - b.p) > 1e-5f || dot(a.ng, b.ng) < 0.999f ||
                     a.primitive != b.primitive || std::abs(a.distance - b.distance) > 1e-5f;
        // A ray that leaves it meets something else.
        const Vec3 w = normalize(pointInCube(random));
        SurfaceHit next;
        if (without->intersect({spawnOrigin(a, w), w}, next))
            again += next.material == a.material && next.primitive == a.primitive && a.material == material(1);
    }
    CHECK(out == 0);
    CHECK(different <= 2); // at the diagonal of the bent quad, or at an edge
    CHECK(again == 0);
}
