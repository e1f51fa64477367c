// What textures see of a hit: dp/du and dp/dv by finite differences of uv, the point in the shape's own space.
#include "geometry/curves.h"
#include "geometry/deforming_mesh.h"
#include "geometry/embree_scene_builder.h"
#include "geometry/flat_shapes.h"
#include "geometry/frustum.h"
#include "geometry/mesh.h"
#include "geometry/points.h"
#include "geometry/round_shapes.h"
#include "geometry/torus.h"
#include "render/material.h"
#include "render/surface_input.h"
#include "support/statistics.h"

#include <doctest/doctest.h>
#include <functional>
#include <memory>

using namespace abbe;
using namespace abbe::test;

namespace {

struct Textured final : Material {
    Textured() { traits_ = {.usesTextures = true}; }
    const Bsdf* bsdf(const SurfaceHit&, const Wavelengths&, Arena&) const noexcept override { return nullptr; }
};
const Textured kTextured;

Vec3d aroundPoint(Random& random) {
    return Vec3d(random.uniformDouble(), random.uniformDouble(), random.uniformDouble()) * 2 - Vec3d(1, 1, 1);
}

// Turned, stretched unevenly, mirrored.
const Transform kMirror = Transform::rotate({1, 2, 3}, 0.7)
                              .then(Transform::scale({1.5, 0.8, -1.2}))
                              .then(Transform::rotate({0, 1, 1}, 1.9))
                              .then(Transform::translate({0.3, -0.2, 0.5}));
const Transform kTurn = Transform::rotate({1, 2, 3}, 0.7).then(Transform::scale({1.3, 1.3, 1.3}));
const Transform kTurnedMirror = kTurn.then(Transform::scale({-1, 1, 1}));

std::unique_ptr<Intersector> sceneOf(const Shape& shape, const Transform* instance) {
    EmbreeSceneBuilder builder;
    EmbreeSceneBuilder::Binding binding;
    binding.material = &kTextured;
    if (instance)
        builder.addInstance(builder.addObject({{&shape, binding}}), *instance);
    else
        builder.addShape(shape, binding);
    return builder.build();
}

// The difference of two coordinates of which one may have gone round from 1 to 0.
float turned(float d) { return d > 0.5f ? d - 1 : d < -0.5f ? d + 1 : d; }

struct Differences {
    int compared = 0, wrong = 0;
    double tooFar[2] = {}; // mean of how much a step along an axis exceeds 1
};

// Moves the ray a little along dp/du, or dp/dv, and sees how uv change. `across`: also for v.
Differences differences(const Shape& shape, const Transform* instance, bool across = true, double reach = 1.5) {
    const auto scene = sceneOf(shape, instance);
    Random random(3);
    Differences result;
    int counts[2] = {};
    for (int i = 0; i < 3000; ++i) {
        const Vec3d target = aroundPoint(random) * (0.5 * reach), origin = normalize(aroundPoint(random)) * (4 * reach);
        const Ray ray{Vec3(origin), Vec3(normalize(target - origin)), kInfinity, 0.4f};
        SurfaceHit hit;
        if (!scene->intersect(ray, hit)) continue;
        CHECK(hit.shape == &shape);
        if (std::abs(dot(ray.direction, hit.ng)) < 0.3f) continue;
        for (int axis = 0; axis < (across ? 2 : 1); ++axis) {
            const Vec3 by = axis == 0 ? hit.dpdu : hit.dpdv;
            REQUIRE(isFinite(by));
            if (!(length(by) > 0.02f)) continue; // near a pole
            const float step = 2e-3f / length(by);
            Ray moved = ray;
            moved.origin = ray.origin + by * step;
            SurfaceHit other;
            if (!scene->intersect(moved, other) || other.primitive != hit.primitive || other.element != hit.element ||
                length(other.p - hit.p) > 6e-3f)
                continue;
            if (dot(other.ng, hit.ng) < 0.999f) continue; // around an edge
            ++result.compared;
            ++counts[axis];
            const float du = turned(other.uv.x - hit.uv.x) / step, dv = turned(other.uv.y - hit.uv.y) / step;
            const float wantedU = axis == 0 ? 1.f : 0.f, wantedV = axis == 0 ? 0.f : 1.f;
            const double excess = static_cast<double>(axis == 0 ? du : dv) - 1;
            if (std::abs(excess) < 0.02) result.tooFar[axis] += excess;
            // A coordinate that should not change counts by how far the point goes with it.
            const float size = length(by), offU = (du - wantedU) * length(hit.dpdu),
                        offV = (dv - wantedV) * length(hit.dpdv);
            if (!(std::abs(offU) < 0.02f * size && (!across || std::abs(offV) < 0.02f * size))) ++result.wrong;
        }
    }
    for (int axis = 0; axis < 2; ++axis) result.tooFar[axis] /= std::max(counts[axis], 1);
    return result;
}

void check(const Shape& shape, bool across = true, double reach = 1.5) {
    for (const Transform* instance : {static_cast<const Transform*>(nullptr), &kMirror}) {
        CAPTURE(instance != nullptr);
        const Differences d = differences(shape, instance, across, reach);
        CHECK(d.compared > 300);
        CHECK(d.wrong <= d.compared / 100); // points near a pole, or met twice
        CHECK(std::abs(d.tooFar[0]) < 0.002);
        CHECK(std::abs(d.tooFar[1]) < 0.002);
    }
}

MeshData wavy(bool uvs) {
    MeshData m;
    const int n = 9;
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const float s = static_cast<float>(x) / (n - 1), t = static_cast<float>(y) / (n - 1);
            m.positions.push_back({2 * s - 1, 2 * t - 1, 0.3f * std::sin(3 * s + 2 * t)});
            if (uvs) m.uvs.push_back({2 * s + 0.5f * t, 1.5f * t - 0.2f * s + 3});
        }
    for (std::uint32_t y = 0; y + 1 < n; ++y)
        for (std::uint32_t x = 0; x + 1 < n; ++x) {
            const std::uint32_t a = y * n + x;
            if ((x + y) % 2) {
                m.quads.push_back({a, a + 1, a + n + 1, a + n});
            } else {
                m.triangles.push_back({a, a + 1, a + n + 1});
                m.triangles.push_back({a, a + n + 1, a + n});
            }
        }
    return m;
}

} // namespace

TEST_CASE("dp/du and dp/dv: meshes with and without texture coordinates, boxes, quads" * doctest::test_suite("input")) {
    check(Mesh(wavy(true)));
    check(Mesh(wavy(false)));
    check(Mesh(boxMesh({-0.7, -0.5, -0.6}, {0.7, 0.5, 0.6})));
    check(Mesh(boxMesh({-0.7, -0.5, -0.6}, {0.7, 0.5, 0.6}), true));
    check(Quad({-1, -1, 0}, {1, -0.8f, 0.2f}, {1.2f, 0.9f, 0}, {-0.9f, 1, 0.1f}));
    check(Quad({-1, -1, 0}, {1, -0.8f, 0.2f}, {1.2f, 0.9f, 0}, {-0.9f, 1, 0.1f}, true));
}

TEST_CASE("dp/du and dp/dv: spheres, disks, planes, turned and mirrored") {
    check(Sphere({0.1, 0, 0}, 0.9));
    check(Disk({0.1, 0, 0}, {1, 2, 0.5}, 1.2));
    check(Plane({0.1, 0, 0}, {1, 2, 0.5}));
    for (const Transform& place : {kTurn, kTurnedMirror}) {
        check(Sphere(place.point({0.1, 0, 0}), 0.9, place));
        check(Disk(place.point({0.1, 0, 0}), normalize(place.normal({1, 2, 0.5})), 1.2, place));
        check(Plane(place.point({0.1, 0, 0}), normalize(place.normal({1, 2, 0.5})), place));
    }
    check(Plane(kMirror.point({0.1, 0, 0}), normalize(kMirror.normal({1, 2, 0.5})), kMirror));
    check(Transformed(std::make_unique<Sphere>(Vec3d(0.1, 0, 0), 0.9), kMirror));
    check(Transformed(std::make_unique<Disk>(Vec3d(0.1, 0, 0), Vec3d(0, 0, 1), 1.1), kMirror));
}

TEST_CASE("dp/du and dp/dv: cylinders, cones, tori") {
    for (const Transform& place : {Transform{}, kTurn, kMirror}) {
        check(Frustum(0.7, 0.7, 1.2, true, place));
        check(Frustum(0.9, 0.2, 1.2, true, place));
        check(Frustum(0.9, 0, 1.2, false, place));
        check(Torus(0.8, 0.3, place));
    }
}

TEST_CASE("dp/du and dp/dv: deforming meshes, points, and along curves") {
    MeshData faces = wavy(true);
    MeshStep first{faces.positions, {}}, second = first;
    for (Vec3& p : second.positions) p = {p.x * 1.2f, p.y * 0.9f, p.z + 0.2f * p.x};
    check(DeformingMesh(faces, {first, second}));
    PointData spheres;
    spheres.points = {{{0.2f, 0, 0}, 0.8f}, {{-0.5f, 0.4f, 0.3f}, 0.5f}};
    check(Points(spheres));
    PointData disks;
    disks.form = PointForm::orientedDisk;
    disks.points = {{{0, 0, 0}, 0.9f}};
    disks.normals = {normalize(Vec3{1, 1, 0.3f})};
    check(Points(disks));
    CurveData curve;
    curve.points = {
        {{-2, 0, 0}, 0.4f}, {{-1, 0.3f, 0}, 0.4f}, {{0, 0, 0.2f}, 0.4f}, {{1, 0.2f, 0}, 0.4f}, {{2, 0, 0}, 0.4f}};
    curve.strandSizes = {5};
    check(Curves(curve), false);
}

TEST_CASE("a turned shape keeps its texture") {
    // uv and the own point of a placed shape are those of the unplaced one at the same point.
    struct Pair {
        std::unique_ptr<const Shape> plain, placed;
    };
    for (const Transform& place : {kTurn, kTurnedMirror}) {
        std::vector<Pair> pairs;
        const double scale = 1.3;
        pairs.push_back({std::make_unique<Sphere>(Vec3d(0.1, 0, 0), 0.9),
                         std::make_unique<Sphere>(place.point({0.1, 0, 0}), 0.9 * scale, place)});
        const Vec3d n = normalize(Vec3d(1, 2, 0.5)), m = normalize(place.normal(n));
        pairs.push_back({std::make_unique<Disk>(Vec3d(0.1, 0, 0), n, 1.1),
                         std::make_unique<Disk>(place.point({0.1, 0, 0}), m, 1.1 * scale, place)});
        pairs.push_back({std::make_unique<Plane>(Vec3d(0.1, 0, 0), n),
                         std::make_unique<Plane>(place.point({0.1, 0, 0}), m, place)});
        for (const Pair& pair : pairs) {
            const auto plain = sceneOf(*pair.plain, nullptr);
            EmbreeSceneBuilder builder;
            EmbreeSceneBuilder::Binding binding{.material = &kTextured};
            binding.toOwn = place.inverse();
            builder.addShape(*pair.placed, binding);
            const auto placed = builder.build();
            Random random(5);
            int met = 0;
            for (int i = 0; i < 500; ++i) {
                const Vec3d target = aroundPoint(random) * 0.7, origin = normalize(aroundPoint(random)) * 5;
                SurfaceHit a, b;
                const Ray ray{Vec3(origin), Vec3(normalize(target - origin))};
                const Ray there{Vec3(place.point(origin)), Vec3(normalize(place.vector(target - origin)))};
                if (!plain->intersect(ray, a) || !placed->intersect(there, b)) continue;
                ++met;
                CHECK(length(a.local - b.local) < 3e-5f * (1 + length(a.local)));
                CHECK(std::abs(dot(a.localNormal, b.localNormal)) > 0.9999f);
                CHECK(b.localScale == doctest::Approx(1 / scale));
                CHECK(std::abs(turned(a.uv.x - b.uv.x)) < 1e-4f);
                CHECK(std::abs(turned(a.uv.y - b.uv.y)) < 1e-4f);
            }
            CHECK(met > 100);
        }
    }
}

TEST_CASE("degenerate texture coordinates have no derivatives, but finite footprints (case 10)" *
          doctest::test_suite("input")) {
    MeshData m;
    m.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    m.quads = {{0, 1, 2, 3}};
    using Uvs = std::vector<Vec2>;
    for (const Uvs& uvs :
         {Uvs(4), Uvs{{0, 0}, {1, 1}, {2, 2}, {3, 3}}, Uvs{{0, 0}, {1e-30f, 0}, {1e-30f, 1e-30f}, {0, 1e-30f}},
          Uvs{{0, 0}, {1e30f, 0}, {1e30f, 1e30f}, {0, 1e30f}}}) {
        m.uvs = uvs;
        const Mesh mesh(m);
        const auto scene = sceneOf(mesh, nullptr);
        SurfaceHit hit;
        REQUIRE(scene->intersect({{0.3f, 0.1f, 2}, {0, 0, -1}}, hit));
        CHECK(isFinite(hit.dpdu));
        CHECK(isFinite(hit.dpdv));
        hit.arrival = {0, 0, -1};
        hit.footprint = 0.1f;
        const TextureQuery query(hit);
        for (const float x : {query.du.x, query.du.y, query.dv.x, query.dv.y}) CHECK(std::isfinite(x));
    }
}

TEST_CASE("nobody asks for the parametrisation of plain materials; faces may ask for themselves") {
    struct Plain final : Material {
        const Bsdf* bsdf(const SurfaceHit&, const Wavelengths&, Arena&) const noexcept override { return nullptr; }
    } plain;
    const auto asked = [&](const Shape& shape) {
        EmbreeSceneBuilder builder;
        builder.addShape(shape, {.material = &plain});
        SurfaceHit hit;
        REQUIRE(builder.build()->intersect({{0.1f, 0.2f, 2}, {0, 0, -1}}, hit));
        return lengthSquared(hit.dpdu) > 0;
    };
    CHECK(!asked(Mesh(wavy(true))));
    const std::size_t faces = wavy(true).triangles.size() + wavy(true).quads.size();
    const std::vector<std::uint16_t> choice(faces, 0);
    CHECK(asked(FaceMaterials(std::make_unique<Mesh>(wavy(true)), {&kTextured}, choice)));
    CHECK(!asked(FaceMaterials(std::make_unique<Mesh>(wavy(true)), {&plain}, choice)));
}

TEST_CASE("highlights are stretched along dp/du, however the shape is turned") {
    std::vector<std::unique_ptr<const Shape>> shapes;
    shapes.push_back(std::make_unique<Sphere>(Vec3d(0.1, 0, 0), 0.9));
    shapes.push_back(std::make_unique<Transformed>(std::make_unique<Sphere>(Vec3d(0.1, 0, 0), 0.9), kMirror));
    for (const Transform& place : {kTurn, kTurnedMirror}) {
        shapes.push_back(std::make_unique<Sphere>(place.point({0.1, 0, 0}), 0.9, place));
        shapes.push_back(std::make_unique<Frustum>(0.9, 0.2, 1.2, false, place));
        shapes.push_back(std::make_unique<Torus>(0.8, 0.3, place));
    }
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        CAPTURE(i);
        const auto scene = sceneOf(*shapes[i], nullptr);
        Random random(5);
        int compared = 0, along = 0;
        for (int k = 0; k < 500; ++k) {
            const Vec3d target = aroundPoint(random) * 0.7, origin = normalize(aroundPoint(random)) * 6.0;
            SurfaceHit hit;
            if (!scene->intersect({Vec3(origin), Vec3(normalize(target - origin)), kInfinity, 0.4f}, hit)) continue;
            const Vec3 u = hit.dpdu - hit.ng * dot(hit.ng, hit.dpdu);
            if (!(length(u) > 0.02f)) continue; // near a pole
            ++compared;
            along += std::abs(dot(normalize(u), hit.shading.x)) > 0.999f;
        }
        CHECK(compared > 50);
        CHECK(along == compared);
    }
}
