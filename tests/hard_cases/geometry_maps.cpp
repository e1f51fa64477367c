// Frames, maps and sizes: docs/hard_cases.md, cases 9, 11, 12, 18, 19 and 23.
#include "geometry/embree_scene.h"
#include "geometry/mesh.h"
#include "geometry/mesh_cleanup.h"
#include "support/statistics.h"
#include "unit/geometry/test_meshes.h"

#include <bit>
#include <doctest/doctest.h>

using namespace abbe;
using namespace abbe::test;

TEST_CASE("case 9: a mesh with degenerate faces renders as the clean one") {
    const MeshData clean = icosphere(4, {}, 1);
    MeshData dirty = clean;
    Random random(6);
    const auto any = [&] { return random.bits() % static_cast<std::uint32_t>(clean.positions.size()); };
    for (std::size_t i = 0; i < clean.triangles.size() / 100; ++i) {
        const std::uint32_t a = any(), b = any();
        dirty.triangles.push_back({a, b, a});
        // A copy of a vertex: zero area, different indices.
        dirty.positions.push_back(dirty.positions[a]);
        dirty.triangles.push_back({a, b, static_cast<std::uint32_t>(dirty.positions.size() - 1)});
    }
    const MeshCleanup report = cleanMesh(dirty);
    CHECK_FALSE(report.error);
    CHECK(dirty.triangles.size() == clean.triangles.size());
    const Mesh a(clean), b(dirty);
    EmbreeSceneBuilder ba, bb;
    ba.addShape(a, {});
    bb.addShape(b, {});
    const auto sa = ba.build(), sb = bb.build();
    for (int i = 0; i < 10000; ++i) {
        const Vec3 o(3 * random.uniform() - 1.5f, 3 * random.uniform() - 1.5f, 4);
        SurfaceHit ha, hb;
        REQUIRE(sa->intersect({o, {0, 0, -1}}, ha) == sb->intersect({o, {0, 0, -1}}, hb));
        CHECK(ha.p == hb.p);
    }
}

TEST_CASE("case 9: degenerate faces that nobody removed give no NaN") {
    MeshData m = icosphere(2, {}, 1);
    m.triangles.push_back({0, 0, 1});
    m.triangles.push_back({5, 5, 5});
    m.quads.push_back({0, 1, 1, 0});
    m.normals.assign(m.positions.size(), Vec3());
    const Mesh mesh(m);
    EmbreeSceneBuilder builder;
    builder.addShape(mesh, {});
    const auto scene = builder.build();
    Random random(6);
    for (int i = 0; i < 20000; ++i) {
        const Vec3 o(3 * random.uniform() - 1.5f, 3 * random.uniform() - 1.5f, 4);
        SurfaceHit hit;
        if (!scene->intersect({o, {0, 0, -1}}, hit)) continue;
        REQUIRE(isFinite(hit.p));
        REQUIRE(isFinite(hit.ng));
        REQUIRE(isFinite(hit.shading.x));
        const auto s = mesh.sample(o, random.bits() % mesh.emitterParts(), {random.uniform(), random.uniform()});
        if (s) REQUIRE(isFinite(s->p));
    }
}

TEST_CASE("case 11: flipped vertex normals shade like the right ones") {
    MeshData good = icosphere(4, {}, 1);
    good.normals = good.positions;
    MeshData flipped = good;
    for (std::size_t i = 0; i < flipped.normals.size(); i += 100) flipped.normals[i] = -flipped.normals[i];
    const Mesh mesh(flipped);
    CHECK(mesh.normalReport().inverted > 0);
    EmbreeSceneBuilder builder;
    builder.addShape(mesh, {});
    const auto scene = builder.build();
    Random random(6);
    Moments cosine;
    for (int i = 0; i < 50000; ++i) {
        const Vec3 o(2 * random.uniform() - 1, 2 * random.uniform() - 1, 4);
        SurfaceHit hit;
        if (!scene->intersect({o, {0, 0, -1}}, hit)) continue;
        REQUIRE(dot(hit.shading.z, hit.ng) >= 0);
        cosine.add(static_cast<double>(dot(hit.shading.z, normalize(hit.p))));
    }
    CHECK(cosine.mean() > 0.99);
}

TEST_CASE("case 12: a frame about every direction") {
    const float values[] = {0.f,    -0.f, 1e-38f, -1e-38f, 1e-20f, -1e-20f, 1e-7f,
                            -1e-7f, 0.5f, -0.5f,  1.f,     -1.f,   1e-4f,   -1e-4f};
    for (float x : values)
        for (float y : values)
            for (float z : values) {
                const Vec3d raw(x, y, z);
                if (!(length(raw) > 1e-30)) continue;
                const Vec3 n(normalize(raw));
                const Frame f = Frame::fromNormal(n);
                REQUIRE(std::abs(dot(f.x, f.y)) < 1e-6f);
                REQUIRE(std::abs(dot(f.x, f.z)) < 1e-6f);
                REQUIRE(std::abs(dot(f.y, f.z)) < 1e-6f);
                REQUIRE(std::abs(lengthSquared(f.x) - 1) < 2e-6f);
                REQUIRE(std::abs(lengthSquared(f.y) - 1) < 2e-6f);
                REQUIRE(dot(cross(f.x, f.y), f.z) > 0.999f);
            }
}

TEST_CASE("case 18: singular maps have no inverse") {
    CHECK_FALSE(Transform::scale({0, 1, 1}).inverse());
    CHECK_FALSE(Transform::scale({0, 0, 0}).inverse());
    CHECK_FALSE(Transform::scale({1e-40, 1, 1}).inverse());
    CHECK(Transform::scale({1e-20, 1e-20, 1e-20}).inverse()); // small, but not singular
    CHECK(Transform::scale({1e9, 1e9, 1e9}).inverse());
    Transform flat; // two equal rows
    flat.a[1][0] = 1;
    flat.a[1][1] = 0;
    CHECK_FALSE(flat.inverse());
    Transform bad;
    bad.a[2][2] = std::numeric_limits<double>::quiet_NaN();
    CHECK_FALSE(bad.inverse());
    CHECK_FALSE(bad.isFinite());
}

TEST_CASE("case 19: sixteen rotations in a row move a hit by less than 1e-5") {
    const Mesh mesh(icosphere(3, {}, 1));
    Transform chain, back;
    for (int i = 0; i < 16; ++i) {
        const Transform step =
            Transform::translate({0.1 * i, 0.2, -0.1}).then(Transform::rotate({1.0 + i, 2, 3}, 0.3 * i));
        chain = chain.then(step);
        back = step.inverse()->then(back);
    }
    const Transform identity = chain.then(back);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) CHECK(std::abs(identity.a[i][j] - (i == j)) < 1e-13);
    EmbreeSceneBuilder placed, plain;
    placed.addInstance(placed.addObject({{&mesh, {}}}), chain);
    plain.addShape(mesh, {});
    const auto a = placed.build(), b = plain.build();
    Random random(1);
    for (int i = 0; i < 5000; ++i) {
        const Vec3d o(random.uniformDouble() - 0.5, random.uniformDouble() - 0.5, 4);
        SurfaceHit ha, hb;
        REQUIRE(b->intersect({Vec3(o), {0, 0, -1}}, hb));
        REQUIRE(a->intersect({Vec3(chain.point(o)), Vec3(chain.vector({0, 0, -1}))}, ha));
        CHECK(length(Vec3d(ha.p) - chain.point(Vec3d(hb.p))) < 2e-5);
    }
}

TEST_CASE("case 23: sizes that pass 32 bits are refused, not wrapped") {
    // Counting only: a span of this size cannot be made in a test.
    MeshData m;
    m.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    m.triangles = {{0, 1, 2}};
    CHECK_FALSE(cleanMesh(m).error);
    static_assert(sizeof(MeshData().triangles.size()) == 8);
    static_assert(sizeof(RawHit().primitive) == 4);
}
