#include "geometry/embree_scene_builder.h"
#include "geometry/mesh.h"
#include "shape_test_support.h"
#include "support/whole_emitter.h"
#include "test_meshes.h"

#include <doctest/doctest.h>

using namespace abbe;
using namespace abbe::test;

TEST_CASE("mesh: quads are the two triangles that Embree traces, bent ones too") {
    MeshData m;
    m.positions = {{0, 0, 0}, {1, 0, 0.2f}, {1.2f, 1, 0}, {0, 1, 0.4f}};
    m.quads = {{0, 1, 2, 3}};
    m.triangles = {{0, 1, 3}}; // the same as half of the quad: parts are told apart
    for (Vec3& p : m.positions) m.uvs.push_back({p.x, p.y});
    for (bool triangles : {false, true}) {
        MeshData data = m;
        if (!triangles)
            data.triangles.clear();
        else
            for (Vec3& p : data.positions) p = p + Vec3(0, 0, 0);
        const Mesh mesh(data);
        const auto scene = intersectorOf(mesh);
        Random random(1);
        int second = 0;
        for (int i = 0; i < 2000; ++i) {
            const Ray ray{{1.2f * random.uniform(), random.uniform(), 5}, {0, 0, -1}};
            SurfaceHit hit;
            if (!scene->intersect(ray, hit)) continue;
            // The point is on the ray, on the face's plane, and the uv is the position.
            CHECK(std::abs(hit.p.x - ray.origin.x) < 1e-5f);
            CHECK(std::abs(hit.p.y - ray.origin.y) < 1e-5f);
            CHECK(std::abs(hit.uv.x - hit.p.x) < 1e-5f);
            CHECK(std::abs(hit.uv.y - hit.p.y) < 1e-5f);
            const bool far = hit.p.x * 1 + hit.p.y * 1 > 1;
            const auto& p = data.positions;
            const Vec3 n =
                far ? normalize(cross(p[3] - p[2], p[1] - p[2])) : normalize(cross(p[1] - p[0], p[3] - p[0]));
            if (std::abs(hit.p.x + hit.p.y - 1) > 1e-3f) CHECK(length(hit.ng - n) < 1e-5f);
            CHECK(hit.shading.x.x > 0.9f); // along dp/du
            if (far) CHECK(hit.primitive == (triangles ? 1u : 0u));
            second += far;
        }
        CHECK(second > 300);
    }
}

// docs/hard_cases.md, case 11.
TEST_CASE("mesh: vertex normals that are absent, zero, not finite or inverted" * doctest::test_suite("input")) {
    MeshData m;
    m.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    m.triangles = {{0, 1, 2}};
    const auto hitOf = [&](std::vector<Vec3> normals) {
        MeshData data = m;
        data.normals = std::move(normals);
        const Mesh mesh(data);
        const auto scene = intersectorOf(mesh);
        SurfaceHit hit;
        REQUIRE(scene->intersect({{0.25f, 0.25f, 1}, {0, 0, -1}}, hit));
        return std::pair(hit, mesh.normalReport());
    };
    const float nan = std::numeric_limits<float>::quiet_NaN();
    CHECK(hitOf({}).first.shading.z == Vec3(0, 0, 1));
    CHECK(hitOf({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}).first.shading.z == Vec3(0, 0, 1));
    CHECK(hitOf({{nan, 0, 0}, {0, 0, 1}, {0, 0, 1}}).first.shading.z == Vec3(0, 0, 1));
    CHECK(hitOf({{nan, 0, 0}, {0, 0, 0}, {0, 0, 1}}).second.missing == 2);
    const auto inverted = hitOf({{0.1f, 0, -1}, {0, 0, -1}, {0, 0, -1}});
    CHECK(inverted.first.shading.z.z > 0.9f);
    CHECK(inverted.second.inverted == 3);
    const auto smooth = hitOf({{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}).first;
    CHECK(smooth.shading.z.x == doctest::Approx(0.25 / std::sqrt(1.125)).epsilon(1e-5));
    CHECK(smooth.ng == Vec3(0, 0, 1));
    CHECK(std::abs(dot(smooth.shading.x, smooth.shading.z)) < 1e-6f);
}

// docs/hard_cases.md, case 10.
TEST_CASE("mesh: uvs that give no direction leave a finite frame" * doctest::test_suite("input")) {
    MeshData m;
    m.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    m.triangles = {{0, 1, 2}};
    const std::vector<std::vector<Vec2>> all = {{{0.5f, 0.5f}, {0.5f, 0.5f}, {0.5f, 0.5f}},
                                                {{0, 0}, {1, 1}, {2, 2}},
                                                {{0, 0}, {1e-30f, 0}, {0, 1e-30f}},
                                                {{0, 0}, {1e30f, 0}, {0, 1e30f}},
                                                {{1e6f, 1e6f}, {1e6f, 1e6f}, {1e6f, 1e6f}}};
    for (const auto& uvs : all) {
        m.uvs = uvs;
        const Mesh mesh(m);
        const auto scene = intersectorOf(mesh);
        SurfaceHit hit;
        REQUIRE(scene->intersect({{0.25f, 0.25f, 1}, {0, 0, -1}}, hit));
        CHECK(isFinite(hit.shading.x));
        CHECK(length(hit.shading.x) == doctest::Approx(1).epsilon(1e-5));
        CHECK(dot(cross(hit.shading.x, hit.shading.y), hit.shading.z) == doctest::Approx(1).epsilon(1e-5));
    }
    // Mirrored uvs: x still runs with growing u.
    m.uvs = {{1, 0}, {0, 0}, {1, 1}};
    const Mesh mesh(m);
    SurfaceHit hit;
    REQUIRE(intersectorOf(mesh)->intersect({{0.25f, 0.25f, 1}, {0, 0, -1}}, hit));
    CHECK(hit.shading.x.x == doctest::Approx(-1));
}

TEST_CASE("mesh: sampling meets faces in proportion to their area") {
    MeshData m = icosphere(1, {}, 1);
    for (Vec3& p : m.positions) p.z *= 3;
    m.triangles.push_back({0, 0, 1}); // never drawn
    const Mesh mesh(m);
    Random random(9);
    std::vector<double> observed(m.triangles.size(), 0.0), expected;
    for (const auto& [a, b, c] : m.triangles)
        expected.push_back(
            0.5 * static_cast<double>(length(cross(m.positions[b] - m.positions[a], m.positions[c] - m.positions[a]))));
    constexpr int n = 100000;
    double total = 0;
    for (double e : expected) total += e;
    CHECK(mesh.area() == doctest::Approx(total).epsilon(1e-5));
    for (double& e : expected) e *= n / total;
    const WholeEmitter whole(mesh);
    const auto scene = intersectorOf(mesh);
    for (int i = 0; i < n; ++i) {
        const auto s =
            whole.sample(Vec3{0, 0, 0}, 0, {random.uniform(), random.uniform()}); // from inside: all faces are seen
        REQUIRE(s);
        SurfaceHit hit;
        REQUIRE(scene->intersect({{0, 0, 0}, normalize(s->p)}, hit));
        ++observed[hit.primitive];
    }
    CHECK(chiSquareTest(observed, expected).pValue > 1e-4);
}

// docs/hard_cases.md, case 9.
TEST_CASE("cleanMesh: removes faces without area and nothing else" * doctest::test_suite("input")) {
    MeshData m = icosphere(3, {}, 1);
    const std::size_t good = m.triangles.size();
    m.triangles.push_back({0, 0, 1});
    m.triangles.push_back({3, 4, 3});
    m.positions.push_back({2, 0, 0});
    m.positions.push_back({2, 0, 0}); // duplicated vertex
    const auto n = static_cast<std::uint32_t>(m.positions.size());
    m.triangles.push_back({0, n - 2, n - 1});
    m.positions.push_back({3, 0, 0}); // collinear
    m.positions.push_back({4, 0, 0});
    m.triangles.push_back({n - 1, n, n + 1});
    m.quads = {{0, 1, 2, 2}, {0, 1, 0, 2}, {5, 5, 5, 5}, {n - 2, n - 1, n, n + 1}, {0, 1, 2, 3}};
    const MeshCleanup report = cleanMesh(m);
    CHECK_FALSE(report.error);
    CHECK(report.repeatedIndices == 4);
    CHECK(report.zeroArea == 3);
    CHECK(report.quadsToTriangles == 1);
    CHECK(m.triangles.size() == good + 1);
    CHECK(m.quads.size() == 1);
}

TEST_CASE("cleanMesh: small faces of a large mesh stay" * doctest::test_suite("input")) {
    MeshData m;
    m.positions = {{0, 0, 0}, {1e5f, 0, 0}, {0, 1e5f, 0}, {1e-3f, 0, 0}, {0, 1e-3f, 0}};
    m.triangles = {{0, 1, 2}, {0, 3, 4}};
    const MeshCleanup report = cleanMesh(m);
    CHECK(report.removed() == 0);
    CHECK(m.triangles.size() == 2);
}

TEST_CASE("cleanMesh: names what makes a mesh unusable" * doctest::test_suite("input")) {
    MeshData m;
    m.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    m.triangles = {{0, 1, 2}};
    const auto errorOf = [](MeshData data) { return cleanMesh(data).error.value_or(""); };
    CHECK(errorOf(m).empty());
    MeshData bad = m;
    bad.triangles.push_back({0, 1, 3});
    CHECK(errorOf(bad) == "triangle 1 refers to vertex 3, but there are 3 vertices");
    bad = m;
    bad.quads.push_back({0, 1, 2, 0xffffffffu});
    CHECK(errorOf(bad).starts_with("quad 0 refers to vertex 4294967295"));
    bad = m;
    bad.positions[1].y = std::numeric_limits<float>::quiet_NaN();
    CHECK(errorOf(bad) == "the position of vertex 1 is not finite");
    bad = m;
    bad.normals = {{0, 0, 1}};
    CHECK(errorOf(bad) == "1 normals for 3 vertices");
    bad = m;
    bad.uvs = {{0, 0}, {0, kInfinity}, {0, 0}};
    CHECK(errorOf(bad) == "the uv of vertex 1 is not finite");
}
