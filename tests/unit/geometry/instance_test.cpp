// Instances: one level, many, inside each other; what they promise about points, errors and distances.
#include "geometry/embree_scene_builder.h"
#include "geometry/instance_table.h"
#include "geometry/mesh.h"
#include "geometry/round_shapes.h"
#include "support/numbered_materials.h"
#include "support/statistics.h"
#include "test_meshes.h"

#include <doctest/doctest.h>

using namespace abbe;
using namespace abbe::test;

namespace {

Vec3d around(Random& random) {
    return Vec3d(random.uniformDouble(), random.uniformDouble(), random.uniformDouble()) * 2 - Vec3d(1, 1, 1);
}

// Turned, scaled differently along the axes, sheared, every second one mirrored.
Transform randomMap(Random& random, int i) {
    const auto factor = [&] { return std::exp(1.5 * (2 * random.uniformDouble() - 1)); };
    Transform shear;
    shear.a[0][1] = random.uniformDouble() - 0.5;
    return Transform::rotate(around(random), 6 * random.uniformDouble())
        .then(Transform::scale({factor(), factor(), i % 2 ? -factor() : factor()}))
        .then(shear)
        .then(Transform::rotate(around(random), 6 * random.uniformDouble()))
        .then(Transform::translate(around(random) * 5));
}

struct InstanceComparison {
    int met = 0, differing = 0;
};

// Rays at the box about `centre` against two scenes that ought to be the same. Silhouettes and edges may differ.
InstanceComparison compare(const Intersector& a, const Intersector& b, Vec3d centre, double size, int rays,
                           Random& random) {
    InstanceComparison result;
    for (int i = 0; i < rays; ++i) {
        const Vec3d target = centre + around(random) * size, origin = centre + normalize(around(random)) * (3 * size);
        Ray ray{Vec3(origin), Vec3(normalize(target - origin))};
        SurfaceHit ha, hb;
        const bool ma = a.intersect(ray, ha), mb = b.intersect(ray, hb);
        if (b.occluded(ray) != mb) ++result.differing;
        if (ma != mb) ++result.differing;
        if (!ma || !mb) continue;
        ++result.met;
        const float far = static_cast<float>(size);
        if (length(ha.p - hb.p) > 1e-4f * far || length(ha.ng - hb.ng) > 2e-3f || ha.material != hb.material) {
            ++result.differing;
            continue;
        }
        REQUIRE(ha.distance == doctest::Approx(hb.distance).epsilon(1e-4));
        // The distance is that along the outer ray, whatever the scale inside.
        ray.tMax = hb.distance * 0.999f;
        if (b.occluded(ray)) ++result.differing;
        ray.tMax = hb.distance * 1.001f;
        if (!b.occluded(ray)) ++result.differing;
    }
    return result;
}

} // namespace

TEST_CASE("instance: maps that place nothing are named, small and mirrored ones are not" *
          doctest::test_suite("input")) {
    CHECK_FALSE(Placement::findFault(Transform()));
    CHECK_FALSE(Placement::findFault(Transform::scale({-1, 1e-6, 1e6})));
    CHECK_FALSE(Placement::findFault(Transform::scale({1e-9, 1e-9, 1e-9})));
    CHECK(Placement::findFault(Transform::scale({1, 0, 1})).value().find("flattens") != std::string::npos);
    CHECK(Placement::findFault(Transform::scale({1e-31, 1, 1})).value().find("flattens") != std::string::npos);
    CHECK(Placement::findFault(Transform::scale({1e-20, 1e-20, 1e-20})).value().find("small") != std::string::npos);
    CHECK(Placement::findFault(Transform::scale({1e30, 1e30, 1e30})).value().find("large") != std::string::npos);
    CHECK(Placement::findFault(Transform::translate({0, std::nan(""), 0})).value().find("finite") != std::string::npos);
    CHECK(Placement::findFault(Transform::translate({0, 1e300, 0})).has_value());
    // What is used is rounded indeed.
    CHECK(Placement(Transform::translate({0.1, 0, 0})).map().t.x == static_cast<double>(0.1f));
}

TEST_CASE("instance: rays inwards are the inverse's, and boxes hold what they enclose") {
    Random random(5);
    for (int i = 0; i < 2000; ++i) {
        const Transform map = randomMap(random, i);
        const Placement placement(map);
        const Transform inverse = *placement.map().inverse();
        const Ray ray{Vec3(around(random) * 10), Vec3(normalize(around(random)))};
        const Ray inside = placement.toObject(ray);
        const Vec3d o = inverse.point(Vec3d(ray.origin)), d = inverse.vector(Vec3d(ray.direction));
        REQUIRE(length(Vec3d(inside.origin) - o) <= 1e-7 * length(o));
        REQUIRE(length(Vec3d(inside.direction) - d) <= 1e-7 * length(d));
        const Bounds3 box{{-0.1f, -0.2f, 0.3f}, {0.4f, 0.1f, 0.5f}}, outer = placement.toOuter(box);
        for (int corner = 0; corner < 8; ++corner) {
            const Vec3 p(corner & 1 ? box.upper.x : box.lower.x, corner & 2 ? box.upper.y : box.lower.y,
                         corner & 4 ? box.upper.z : box.lower.z);
            const Vec3 q(placement.map().point(Vec3d(p)));
            for (int axis = 0; axis < 3; ++axis)
                REQUIRE((q[axis] >= outer.lower[axis] && q[axis] <= outer.upper[axis]));
        }
    }
}

// docs/hard_cases.md, cases 17 and 18.
TEST_CASE("instance: random maps give the hits of the baked mesh") {
    const MeshData data = icosphere(3, {0.2, 0, -0.1}, 1);
    const Mesh mesh(data);
    Random random(11);
    InstanceComparison all;
    for (int i = 0; i < 50; ++i) {
        const Transform map = Placement(randomMap(random, i)).map();
        const Mesh baked(moved(data, map));
        EmbreeSceneBuilder a, b;
        a.addShape(baked, {material(1), nullptr});
        b.addInstance(b.addObject({{&mesh, {material(1), nullptr}}}), map);
        const auto direct = a.build(), instanced = b.build();
        const Bounds3 box = direct->bounds();
        const InstanceComparison c = compare(*direct, *instanced, Vec3d(box.centre()),
                                             0.6 * static_cast<double>(maxComponent(box.diagonal())), 2000, random);
        all.met += c.met;
        all.differing += c.differing;
        for (int axis = 0; axis < 3; ++axis) { // of the box's box: never smaller
            CHECK(instanced->bounds().lower[axis] <= box.lower[axis]);
            CHECK(instanced->bounds().upper[axis] >= box.upper[axis]);
        }
    }
    CHECK(all.met > 20000);
    CHECK(all.differing < all.met / 500);
}

TEST_CASE("instance: objects in objects are what they would be side by side" * doctest::test_suite("input")) {
    const Mesh ball(icosphere(2, {}, 0.3));
    const Sphere stone({0, -0.6, 0}, 0.25);
    Random random(23);
    std::vector<Transform> twigs, trees, forests;
    for (int i = 0; i < 6; ++i) twigs.push_back(randomMap(random, i).then(Transform::scale({0.2, 0.2, 0.2})));
    for (int i = 0; i < 5; ++i) trees.push_back(randomMap(random, i));
    for (int i = 0; i < 3; ++i) forests.push_back(randomMap(random, i));

    EmbreeSceneBuilder nested, flat;
    const auto twig = nested.addObject({{&ball, {material(1), nullptr}}});
    const auto tree = nested.addObject({{&stone, {material(2), nullptr}}, {&ball, {material(3), nullptr}}});
    const auto forest = nested.addObject({});
    const auto flatTwig = flat.addObject({{&ball, {material(1), nullptr}}});
    const auto flatTree = flat.addObject({{&stone, {material(2), nullptr}}, {&ball, {material(3), nullptr}}});
    for (const Transform& t : twigs) nested.addInstance(twig, t, tree);
    for (const Transform& t : trees) nested.addInstance(tree, t, forest);
    nested.addInstance(twig, Transform(), forest); // one object at two depths
    for (const Transform& f : forests) {
        nested.addInstance(forest, f);
        flat.addInstance(flatTwig, f);
        for (const Transform& t : trees) {
            flat.addInstance(flatTree, t.then(f));
            for (const Transform& w : twigs) flat.addInstance(flatTwig, w.then(t).then(f));
        }
    }
    const auto a = flat.build(), b = nested.build();
    const InstanceComparison c = compare(*a, *b, {0, 0, 0}, 8, 100000, random);
    CHECK(c.met > 5000);
    CHECK(c.differing < c.met / 200);
    CHECK(b->rejectedRays() == 0);
}

TEST_CASE("instance: hits tell which placement they belong to") {
    const Mesh ball(icosphere(2, {}, 0.3));
    EmbreeSceneBuilder builder;
    const auto inner = builder.addObject({{&ball, {}}}), outer = builder.addObject({{&ball, {}}});
    builder.addInstance(inner, Transform::translate({0, 1, 0}), outer);
    std::vector<Placement> row;
    for (int i = 0; i < 100; ++i) row.emplace_back(Transform::translate({1.0 * i, 0, 0}));
    builder.addInstances(inner, row);
    builder.addInstance(outer, Transform::translate({0, 5, 0}));
    const Mesh plain(icosphere(2, {0, -5, 0}, 0.3));
    builder.addShape(plain, {});
    const auto scene = builder.build();
    SurfaceHit hit;
    for (int i = 0; i < 100; i += 9) {
        REQUIRE(scene->intersect({{static_cast<float>(i), 0.01f, 5}, {0, 0, -1}}, hit));
        CHECK(hit.instance == static_cast<std::uint32_t>(i));
    }
    for (const float y : {5.f, 6.f}) {
        REQUIRE(scene->intersect({{0.01f, y, 5}, {0, 0, -1}}, hit));
        CHECK(hit.instance == 100);
    }
    REQUIRE(scene->intersect({{0.01f, -5, 5}, {0, 0, -1}}, hit));
    CHECK(hit.instance == SurfaceHit::kNoInstance);
}

// docs/hard_cases.md, case 19, with sixteen levels that are really traversed.
TEST_CASE("instance: sixteen rotations inside each other move a hit by less than 1e-5") {
    const Mesh mesh(icosphere(3, {}, 1));
    EmbreeSceneBuilder builder;
    std::uint32_t object = builder.addObject({{&mesh, {}}});
    Transform chain;
    for (int i = 0; i < 16; ++i) {
        const Transform step =
            Placement(Transform::translate({0.1 * i, 0.2, -0.1}).then(Transform::rotate({1.0 + i, 2, 3}, 0.3 * i)))
                .map();
        const std::uint32_t outer = i < 15 ? builder.addObject({}) : EmbreeSceneBuilder::kScene;
        builder.addInstance(object, step, outer);
        chain = chain.then(step);
        object = outer;
    }
    EmbreeSceneBuilder plain;
    plain.addShape(mesh, {});
    const auto a = builder.build(), b = plain.build();
    Random random(1);
    double worst = 0;
    int unbounded = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3d o(random.uniformDouble() - 0.5, random.uniformDouble() - 0.5, 4);
        SurfaceHit ha, hb;
        REQUIRE(b->intersect({Vec3(o), {0, 0, -1}}, hb));
        const Ray ray{Vec3(chain.point(o)), Vec3(chain.vector({0, 0, -1}))};
        REQUIRE(a->intersect(ray, ha));
        worst = std::max(worst, length(Vec3d(ha.p) - chain.point(Vec3d(hb.p))));
        // No ray that leaves the convex ball meets it again: the bound has grown by all sixteen maps.
        const Vec3 w = Frame::fromNormal(ha.ng).toWorld(
            normalize(Vec3(static_cast<float>(around(random).x), static_cast<float>(around(random).y), 0.02f)));
        SurfaceHit again;
        unbounded += a->intersect({spawnOrigin(ha, w), w}, again);
    }
    CHECK(worst < 1e-5);
    CHECK(unbounded == 0);
}

// docs/hard_cases.md, cases 2 and 19: the rounding of the map is part of the bound.
TEST_CASE("instance: rays leave convex objects far away without meeting them again") {
    const Mesh mesh(icosphere(3, {}, 1));
    const Transform map = Transform::rotate({1, 2, 3}, 1)
                              .then(Transform::scale({1, 3, 0.5}))
                              .then(Transform::translate({1000, -2000, 500}));
    EmbreeSceneBuilder builder;
    const auto ball = builder.addObject({{&mesh, {}}}), group = builder.addObject({});
    builder.addInstance(ball, Transform::translate({-400, 0, 300}), group);
    builder.addInstance(group, map);
    const auto scene = builder.build();
    Random random(8);
    int met = 0, again = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3d o = around(random) * 3 + Vec3d(-400, 0, 300), target = around(random) * 0.5 + Vec3d(-400, 0, 300);
        const Vec3 from(map.point(o));
        SurfaceHit hit, other;
        if (!scene->intersect({from, normalize(Vec3(map.point(target)) - from)}, hit)) continue;
        if (dot(hit.ng, from - hit.p) <= 0) continue; // from inside
        ++met;
        const Vec3d side = around(random);
        const Vec3 w = Frame::fromNormal(hit.ng).toWorld(
            normalize(Vec3(static_cast<float>(side.x), static_cast<float>(side.y), i % 2 ? 0.02f : 1.f)));
        again += scene->intersect({spawnOrigin(hit, w), w}, other);
    }
    CHECK(met > 10000);
    CHECK(again == 0);
}

TEST_CASE("instance: slivers met edge-on are resolved inside instances, too") {
    // Long thin triangles in a fan, nearly in the plane of the rays.
    MeshData fan;
    for (int i = 0; i <= 200; ++i) {
        fan.positions.push_back({0.1f * static_cast<float>(i), 0, 0});
        fan.positions.push_back({0.1f * static_cast<float>(i) + 0.05f, 1e-4f, 900});
    }
    for (std::uint32_t i = 0; i < 200; ++i) fan.triangles.push_back({2 * i, 2 * i + 2, 2 * i + 1});
    const Mesh mesh(fan);
    const Transform map = Placement(Transform::rotate({1, 2, 3}, 0.7).then(Transform::scale({0.5, 3, -2}))).map();
    EmbreeSceneBuilder builder;
    builder.addInstance(builder.addObject({{&mesh, {}}}), map);
    const auto scene = builder.build();
    Random random(3);
    int met = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3d o(20 * random.uniformDouble(), 1e-3, -10), target(20 * random.uniformDouble(), 0, 900);
        const Vec3d from = map.point(o), to = map.point(target);
        const Ray ray{Vec3(from), Vec3(normalize(to - from))};
        SurfaceHit hit;
        if (!scene->intersect(ray, hit)) continue;
        ++met;
        const Vec3d e = Vec3d(hit.p) - Vec3d(ray.origin);
        REQUIRE(length(cross(e, Vec3d(ray.direction))) < 1e-4 * length(e) + 1e-3);
    }
    CHECK(met > 1000);
}
