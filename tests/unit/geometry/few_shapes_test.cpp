// Small scenes without a tree, beside each of its primitives by itself in double, and beside the tree.
#include "geometry/embree_scene_builder.h"
#include "geometry/few_shapes.h"
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

using Polygon = FewPolygons::Polygon;

Vec3 pointInCube(Random& random) {
    return {2 * random.uniform() - 1, 2 * random.uniform() - 1, 2 * random.uniform() - 1};
}

std::vector<Polygon> triangles(std::size_t count, Random& random) {
    std::vector<Polygon> all;
    for (std::uint32_t i = 0; i < count; ++i)
        all.push_back(
            {{pointInCube(random), pointInCube(random), pointInCube(random)}, false, i, 7 * i, kVisibleToAll});
    return all;
}

// Flat, convex and of no other symmetry: cut from a plane across an axis, whose coordinates are exact. Every third one
// is bent, and every fifth not convex.
std::vector<Polygon> quads(std::size_t count, Random& random) {
    std::vector<Polygon> all;
    for (std::uint32_t i = 0; i < count; ++i) {
        const Vec3 c = pointInCube(random);
        const std::size_t across = i % 3, x = (across + 1) % 3, y = (across + 2) % 3;
        Polygon quad{{}, true, i, 7 * i, kVisibleToAll};
        for (std::size_t k = 0; k < 4; ++k) {
            const float angle = 0.5f * kPi * (static_cast<float>(k) + 0.6f * random.uniform());
            const float reach = i % 5 == 4 && k == 2 ? -0.1f : 0.5f;
            std::array<float, 3> p{};
            p[across] = c[static_cast<int>(across)];
            p[x] = c[static_cast<int>(x)] + reach * std::cos(angle);
            p[y] = c[static_cast<int>(y)] + reach * std::sin(angle);
            if (i % 3 == 2 && k == 2) p[across] += 0.2f;
            quad.corners[k] = {p[0], p[1], p[2]};
        }
        all.push_back(quad);
    }
    return all;
}

struct Truth {
    double t = std::numeric_limits<double>::infinity(), u = 0, v = 0;
    std::size_t index = 0;
    bool certain = true; // no ray near it hits anything else
};

// [Moller1997], of quads in both halves as Embree splits them.
Truth nearest(const std::vector<Polygon>& all, const Ray& ray) {
    Truth truth;
    const auto meet = [&](std::size_t i, Vec3 first, Vec3 second, Vec3 third, bool secondHalf) {
        const Vec3d a(first), e1 = Vec3d(second) - a, e2 = Vec3d(third) - a;
        const Vec3d d(ray.direction), s = Vec3d(ray.origin) - a, p = cross(d, e2), q = cross(s, e1);
        const double f = 1 / dot(e1, p), u = f * dot(s, p), v = f * dot(d, q), t = f * dot(e2, q);
        const double least = std::min({u, v, 1 - u - v});
        if (std::abs(least) < 1e-3) truth.certain = false;
        if (least >= 0 && t > 0 && t < truth.t) {
            if (truth.t - t < 1e-3) truth.certain = false;
            truth = {t, secondHalf ? 1 - u : u, secondHalf ? 1 - v : v, i, truth.certain};
        } else if (least >= 0 && std::abs(t - truth.t) < 1e-3) {
            truth.certain = false;
        }
    };
    for (std::size_t i = 0; i < all.size(); ++i) {
        const auto& [a, b, c, d] = all[i].corners;
        meet(i, a, b, all[i].quad ? d : c, false);
        if (all[i].quad) meet(i, c, d, b, true);
    }
    return truth;
}

void checkAgainstTruth(const std::vector<Polygon>& all, Random& random) {
    const auto few = FewPolygons::make(all);
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
    CAPTURE(all.size());
    CHECK(compared > 1000);
    CHECK(wrong == 0);
}

} // namespace

TEST_CASE("few shapes: the nearest polygon is found, and shadow rays end at any") {
    Random random(3);
    for (const std::size_t count : {1u, 7u, 8u, 9u, 40u, 64u}) {
        checkAgainstTruth(triangles(count, random), random);
        checkAgainstTruth(quads(count, random), random);
        std::vector<Polygon> both = quads(count, random);
        for (Polygon triangle : triangles(5, random)) {
            triangle.record = static_cast<std::uint32_t>(both.size());
            triangle.primitive = 7 * triangle.record;
            both.push_back(triangle);
        }
        checkAgainstTruth(both, random);
    }
}

namespace {

void checkPlane(bool quad) {
    const Vec3 last{0, 1, 0};
    const std::array<Vec3, 4> corners{Vec3{0, 0, 0}, Vec3{1, 0, 0}, quad ? Vec3{0.9f, 0.8f, 0} : last, last};
    const std::vector<Polygon> one{{corners, quad, 0, 0, Visibility(RayKind::camera) | RayKind::shadow}};
    const auto few = FewPolygons::make(one);
    REQUIRE(few);
    const Ray down{{0.2f, 0.2f, 1}, {0, 0, -1}, kInfinity, 0, RayKind::camera};
    CHECK(few->intersect(down));
    Ray other = down;
    other.kind = RayKind::shadow;
    CHECK(few->occluded(other));
    other.kind = RayKind::scattered;
    CHECK_FALSE(few->occluded(other));
    CHECK_FALSE(few->intersect(other));
    for (const Vec3 direction :
         {Vec3{1, 0, 0}, Vec3{0, -1, 0}, normalize(Vec3{1, 2, 0}), normalize(Vec3{-2, 1, 0}), Vec3{0, 0, 1}, Vec3()})
        for (const float z : {0.f, 1.f})
            CHECK_FALSE(few->intersect({{0.2f, 0.2f, z}, direction, kInfinity, 0, RayKind::camera}));
    CHECK_FALSE(few->intersect({{0.2f, 0.2f, 0}, {0, 0, -1}, kInfinity, 0, RayKind::camera}));
}

} // namespace

TEST_CASE("few shapes: nothing lies along a plane, at the start of a ray, or where it is not seen") {
    checkPlane(false);
    checkPlane(true);
}

TEST_CASE("few shapes: too many, too small for their distance, moving, or something else is for the tree") {
    Random random(5);
    CHECK_FALSE(FewPolygons::make({}));
    CHECK_FALSE(FewPolygons::make(triangles(FewPolygons::kMost + 1, random)));
    std::vector<Polygon> far = triangles(2, random);
    for (Vec3& p : far[0].corners) p = p * 0.02f + Vec3{1, 1, 1};
    CHECK(FewPolygons::make(far));
    for (Vec3& p : far[1].corners) p = p * 1e3f;
    CHECK_FALSE(FewPolygons::make(far));
    std::vector<Polygon> flat = triangles(2, random);
    flat[0].corners[2] = flat[0].corners[1];
    CHECK(FewPolygons::make(flat));

    const Quad quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
    const Sphere sphere({5, 0, 0}, 1);
    FewShapesSink sink;
    CHECK(sink.add(quad, kVisibleToAll));
    const auto few = sink.make();
    REQUIRE(few);
    for (const Vec2 p : {Vec2{-0.6f, 0.2f}, Vec2{0.8f, 0.6f}}) { // in either half
        const auto hit = few->intersect({{p.x, p.y, 1}, {0, 0, -1}});
        REQUIRE(hit);
        CHECK(hit->u == doctest::Approx((p.x + 1) / 2));
        CHECK(hit->v == doctest::Approx((p.y + 1) / 2));
    }
    // As many as there are lanes for their boxes.
    for (std::size_t i = 0; i < FewShapes::kMostOwn; ++i) CHECK(sink.add(sphere, kVisibleToAll));
    CHECK(sink.make());
    CHECK_FALSE(sink.add(sphere, kVisibleToAll));
    CHECK_FALSE(sink.make());
}

TEST_CASE("few shapes: what intersects itself is found wherever its box is met") {
    const Sphere left({-0.5, 0, 0}, 0.3), right({0.6, 0.1, 0}, 0.2);
    const Disk disk({0, 0, 0.5}, {0, 0, 1}, 0.7); // its box has no height
    const std::vector<const Shape*> all{&left, &right, &disk};
    FewShapesSink sink;
    for (const Shape* shape : all)
        REQUIRE(sink.add(*shape, shape == &right ? Visibility(RayKind::camera) : kVisibleToAll));
    const auto few = sink.make();
    REQUIRE(few);
    Random random(7);
    int wrong = 0, hits = 0;
    for (int i = 0; i < 20000; ++i) {
        Ray ray{pointInCube(random) * 1.5f, normalize(pointInCube(random))};
        // Along axes, from places in the planes of boxes' sides.
        if (i % 3 == 0) ray.direction = {i % 2 ? 1.f : -1.f, 0, 0};
        if (i % 9 == 0) ray.origin.z = i % 18 ? 0.5f : 0.3f;
        ray.kind = i % 2 ? RayKind::camera : RayKind::scattered;
        if (i % 5 == 0) ray.tMax = random.uniform();
        Ray rest = ray;
        std::optional<std::uint32_t> nearest;
        for (std::uint32_t k = 0; k < all.size(); ++k) {
            if (all[k] == &right && ray.kind != RayKind::camera) continue;
            if (const auto hit = all[k]->intersect(rest)) {
                nearest = k;
                rest.tMax = hit->distance;
            }
        }
        const auto found = few->intersect(ray);
        wrong += found.has_value() != nearest.has_value() || few->occluded(ray) != nearest.has_value();
        if (!found || !nearest) continue;
        ++hits;
        wrong += found->record != *nearest || found->t != rest.tMax;
    }
    CHECK(wrong == 0);
    CHECK(hits > 800);
}

// The same shapes with and without the tree, which many spheres far away ask for.
TEST_CASE("few shapes: surfaces are those that the tree finds, and a box lets no ray out") {
    const Mesh box(cube({-1, -1, -1}, {1, 1, 1}));
    const Quad bent({-0.5f, -0.6f, 0.1f}, {0.5f, -0.6f, 0.2f}, {0.4f, 0.5f, -0.3f}, {-0.6f, 0.4f, 0.3f});
    const Sphere ball({0.3f, 0.5f, 0.5f}, 0.2), away({1e4f, 0, 0}, 1e-3);
    const auto build = [&](bool tree) {
        EmbreeSceneBuilder builder;
        builder.addShape(box, {material(1), nullptr});
        builder.addShape(bent, {material(2), nullptr});
        builder.addShape(ball, {material(3), nullptr});
        for (std::size_t i = 0; tree && i < FewShapes::kMostOwn; ++i) builder.addShape(away, {});
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
