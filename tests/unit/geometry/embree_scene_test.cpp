#include "geometry/embree_scene_builder.h"
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

const SurfaceLight* light(std::uintptr_t i) { return reinterpret_cast<const SurfaceLight*>(16 * i); }

Ray ray(Vec3 origin, Vec3 direction) { return {origin, normalize(direction)}; }

void checkNear(Vec3 a, Vec3 b, float tolerance = 1e-5f) {
    CAPTURE(a.x);
    CAPTURE(a.y);
    CAPTURE(a.z);
    CHECK(length(a - b) <= tolerance);
}

void checkFrame(const SurfaceHit& hit) {
    const Frame& f = hit.shading;
    CHECK(length(f.x) == doctest::Approx(1).epsilon(1e-5));
    CHECK(length(f.y) == doctest::Approx(1).epsilon(1e-5));
    CHECK(length(f.z) == doctest::Approx(1).epsilon(1e-5));
    CHECK(std::abs(dot(f.x, f.y)) < 1e-5f);
    CHECK(dot(cross(f.x, f.y), f.z) == doctest::Approx(1).epsilon(1e-5));
    CHECK(dot(f.z, hit.ng) > 0);
    CHECK(length(hit.ng) == doctest::Approx(1).epsilon(1e-5));
}

} // namespace

TEST_CASE("scene: each shape is met where it is, with its own binding") {
    const Quad quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
    const Sphere sphere({5, 0, 0}, 1);
    const Disk disk({10, 0, 0}, {0, 0, 1}, 1);
    const Plane plane({0, -3, 0}, {0, 2, 0});
    const Mesh mesh(cube({14, -1, -1}, {16, 1, 1}));
    const Transformed ellipsoid(std::make_unique<Sphere>(Vec3d(), 1.0),
                                Transform::scale({1, 1, 3}).then(Transform::translate({20, 0, 0})));
    EmbreeSceneBuilder builder;
    CHECK(builder.addShape(quad, {material(1), light(1)}) == 0);
    CHECK(builder.addShape(sphere, {material(2), nullptr}) == 1);
    builder.addShape(disk, {material(3), light(3)});
    builder.addShape(plane, {material(4), nullptr});
    builder.addShape(mesh, {material(5), light(5)});
    builder.addShape(ellipsoid, {material(6), nullptr});
    const auto scene = builder.build();

    struct Expected {
        Ray ray;
        Vec3 p, ng;
        std::uintptr_t material, light;
    };
    const Expected all[] = {
        {ray({0.5f, 0.25f, 4}, {0, 0, -1}), {0.5f, 0.25f, 0}, {0, 0, 1}, 1, 1},
        {ray({5, 0, 4}, {0, 0, -1}), {5, 0, 1}, {0, 0, 1}, 2, 0},
        {ray({5, 0, 0}, {0, 1, 0}), {5, 1, 0}, {0, 1, 0}, 2, 0}, // from inside
        {ray({10.5f, 0.5f, 4}, {0, 0, -1}), {10.5f, 0.5f, 0}, {0, 0, 1}, 3, 3},
        {ray({-7, 1, 4}, {0, -1, 0}), {-7, -3, 4}, {0, 1, 0}, 4, 0},
        {ray({1e6f, 1, 4}, {0, -1, 0}), {1e6f, -3, 4}, {0, 1, 0}, 4, 0},
        {ray({15.5f, 0.5f, 4}, {0, 0, -1}), {15.5f, 0.5f, 1}, {0, 0, 1}, 5, 5},
        {ray({15, 4, 0.2f}, {0, -1, 0}), {15, 1, 0.2f}, {0, 1, 0}, 5, 5},
        {ray({20, 0, 9}, {0, 0, -1}), {20, 0, 3}, {0, 0, 1}, 6, 0},
    };
    for (const Expected& e : all) {
        SurfaceHit hit;
        REQUIRE(scene->intersect(e.ray, hit));
        checkNear(hit.p, e.p);
        checkNear(hit.ng, e.ng);
        checkFrame(hit);
        CHECK(hit.material == material(e.material));
        CHECK(hit.light == (e.light ? light(e.light) : nullptr));
        CHECK(hit.distance == doctest::Approx(length(e.p - e.ray.origin)).epsilon(1e-6));
        for (int axis = 0; axis < 3; ++axis) CHECK(hit.pError[axis] >= 0);

        Ray shadow = e.ray;
        shadow.tMax = hit.distance * 1.001f;
        CHECK(scene->occluded(shadow));
        CHECK(scene->intersect(shadow, hit));
        shadow.tMax = hit.distance * 0.999f;
        CHECK_FALSE(scene->occluded(shadow));
        CHECK_FALSE(scene->intersect(shadow, hit));
    }
    SurfaceHit hit;
    CHECK_FALSE(scene->intersect(ray({0, 5, 0}, {0, 1, 0}), hit));
    // Planes have no part in the bounds.
    checkNear(scene->bounds().lower, {-1, -1, -3}, 1e-4f);
    checkNear(scene->bounds().upper, {21, 1, 3}, 1e-4f);
    CHECK(scene->rejectedRays() == 0);
}

TEST_CASE("scene: rays that are not finite are refused and counted" * doctest::test_suite("input")) {
    const Quad quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
    EmbreeSceneBuilder builder;
    builder.addShape(quad, {});
    const auto scene = builder.build();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const Ray bad[] = {{{nan, 0, 1}, {0, 0, -1}},       {{0, kInfinity, 1}, {0, 0, -1}}, {{0, 0, 1}, {0, nan, -1}},
                       {{0, 0, 1}, {0, 0, -kInfinity}}, {{0, 0, 1}, {0, 0, -1}, nan},    {{0, 0, 1}, {0, 0, -1}, -1},
                       {{3e18f, 0, 1}, {0, 0, -1}}};
    SurfaceHit hit;
    for (const Ray& r : bad) {
        CHECK_FALSE(scene->intersect(r, hit));
        CHECK_FALSE(scene->occluded(r));
    }
    CHECK(scene->rejectedRays() == 2 * std::size(bad));
    CHECK_FALSE(scene->intersect({{0, 0, 1}, {0, 0, 0}}, hit)); // no direction: a miss, not an abort
    CHECK(scene->intersect({{0, 0, 1}, {0, 0, -1}}, hit));
}

TEST_CASE("scene: empty scenes are built and never met" * doctest::test_suite("input")) {
    const auto scene = EmbreeSceneBuilder().build();
    SurfaceHit hit;
    CHECK_FALSE(scene->intersect({{0, 0, 1}, {0, 0, -1}}, hit));
    CHECK_FALSE(scene->occluded({{0, 0, 1}, {0, 0, -1}}));
    CHECK(scene->bounds().empty());
}

// docs/hard_cases.md, case 17: an instance is what the moved mesh would be.
TEST_CASE("scene: instances equal baked geometry, mirrored and sheared too") {
    MeshData data = icosphere(2, {0.3, 0.2, 0.1}, 1);
    for (Vec3 p : data.positions) data.normals.push_back(normalize(p - Vec3(0.3f, 0.2f, 0.1f)));
    for (Vec3 p : data.positions) data.uvs.push_back({p.x + 0.31f * p.z, 2 * p.y - 0.17f * p.z});
    Transform shear;
    shear.a[0][1] = 0.7;
    const Transform maps[] = {Transform{},
                              Transform::translate({3, -2, 1}),
                              Transform::rotate({1, 2, 3}, 1.1).then(Transform::scale({2, 2, 2})),
                              Transform::scale({-1, 1, 1}).then(Transform::translate({0.5, 0, 0})),
                              Transform::scale({1, -0.4, 2.5}).then(Transform::rotate({0, 1, 1}, 0.4)),
                              shear.then(Transform::scale({1, 1, -1}))};
    const Mesh mesh(data);
    const Sphere sphere({-2, 0, 0}, 0.5);
    for (const Transform& map : maps) {
        const Mesh baked(moved(data, map));
        const Transformed bakedSphere(std::make_unique<Sphere>(Vec3d(-2, 0, 0), 0.5), map);
        EmbreeSceneBuilder a, b;
        a.addShape(baked, {material(1), nullptr});
        a.addShape(bakedSphere, {material(2), nullptr});
        b.addInstance(b.addObject({{&mesh, {material(1), nullptr}}, {&sphere, {material(2), nullptr}}}), map);
        const auto direct = a.build(), instanced = b.build();
        checkNear(direct->bounds().centre(), instanced->bounds().centre(), 1.0f); // boxes of boxes are larger
        Random random(2);
        int met = 0, differing = 0;
        for (int i = 0; i < 5000; ++i) {
            const auto around = [&] {
                return Vec3(random.uniform(), random.uniform(), random.uniform()) * 2 - Vec3(1, 1, 1);
            };
            const Vec3 target(map.point(Vec3d(around() * 2)));
            const Vec3 origin = target + normalize(around()) * 8;
            const Ray r = ray(origin, target - origin);
            SurfaceHit ha, hb;
            const bool ma = direct->intersect(r, ha), mb = instanced->intersect(r, hb);
            CHECK(direct->occluded(r) == ma);
            CHECK(instanced->occluded(r) == mb);
            if (ma != mb) {
                ++differing; // silhouettes
                continue;
            }
            if (!ma) continue;
            ++met;
            const bool sameFace = length(ha.ng - hb.ng) < 1e-3f && length(ha.p - hb.p) < 1e-4f;
            if (!sameFace) {
                ++differing; // edges between faces
                continue;
            }
            CHECK(length(ha.shading.z - hb.shading.z) < 2e-3f);
            // The tangent is made orthogonal before the map or after it: the same only if angles are kept.
            if (map.uniformScale()) CHECK(length(ha.shading.x - hb.shading.x) < 5e-3f);
            CHECK(ha.material == hb.material);
            CHECK(ha.distance == doctest::Approx(hb.distance).epsilon(1e-4));
            CHECK(std::abs(ha.uv.x - hb.uv.x) < 1e-3f);
            if (length(hb.p - Vec3(map.point({-2, 0, 0}))) > 3)
                CHECK(dot(hb.ng, r.direction) < 0); // outside is outside
        }
        CHECK(met > 1000);
        CHECK(differing < 25);
    }
}

TEST_CASE("scene: an object of several shapes, placed many times beside plain shapes" * doctest::test_suite("input")) {
    const Quad quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
    const Sphere sphere({0, 0, -2}, 0.5);
    const Mesh mesh(cube({-0.5f, 2, -0.5f}, {0.5f, 3, 0.5f}));
    const Quad floor({-100, -9, -100}, {-100, -9, 100}, {100, -9, 100}, {100, -9, -100});
    EmbreeSceneBuilder builder;
    const auto first = builder.addObject({{&quad, {material(1), nullptr}}, {&sphere, {material(2), nullptr}}});
    const auto second = builder.addObject({{&mesh, {material(3), nullptr}}});
    for (int i = 0; i < 10; ++i) {
        builder.addInstance(first, Transform::translate({10.0 * i, 0, 0}));
        builder.addInstance(second, Transform::translate({10.0 * i, 0, 0}));
    }
    builder.addShape(floor, {material(4), light(4)});
    const auto scene = builder.build();
    for (int i = 0; i < 10; ++i) {
        SurfaceHit hit;
        const float x = 10.f * static_cast<float>(i);
        REQUIRE(scene->intersect(ray({x, 0, 5}, {0, 0, -1}), hit));
        CHECK(hit.material == material(1));
        checkNear(hit.p, {x, 0, 0});
        REQUIRE(scene->intersect(ray({x, 0, -5}, {0, 0, 1}), hit));
        CHECK(hit.material == material(2));
        checkNear(hit.p, {x, 0, -2.5f});
        REQUIRE(scene->intersect(ray({x, 2.5f, 5}, {0, 0, -1}), hit));
        CHECK(hit.material == material(3));
        checkNear(hit.ng, {0, 0, 1});
    }
    SurfaceHit hit;
    REQUIRE(scene->intersect(ray({5, 0, 0}, {0, -1, 0}), hit));
    CHECK(hit.material == material(4));
    CHECK(hit.light == light(4));
}
