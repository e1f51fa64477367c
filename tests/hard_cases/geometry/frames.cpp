// Faces without area, frames and normals: cases 9 to 12 and 23 of docs/hard_cases.md.
#include "film/pixel_film.h"
#include "geometry/embree_scene_builder.h"
#include "geometry/mesh.h"
#include "geometry/subdivision_surface.h"
#include "geometry/surface_math.h"
#include "hard_cases/hard_case.h"
#include "math/warp.h"
#include "render/material.h"
#include "render/surface_input.h"
#include "support/statistics.h"
#include "unit/geometry/test_meshes.h"

#include <doctest/doctest.h>

using namespace abbe;
using namespace abbe::test;

TEST_CASE("case 9: a mesh with degenerate faces renders as the clean one") {
    HardCase c;
    int different = 0;
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
        different += sa->intersect({o, {0, 0, -1}}, ha) != sb->intersect({o, {0, 0, -1}}, hb) || ha.p != hb.p;
    }
    c.measured("of 1e4 rays at a sphere with 1 % of empty faces, those whose hit differs from the clean one's",
               different, 0);
}

TEST_CASE("case 9: degenerate faces that nobody removed give no NaN") {
    HardCase c;
    int bad = 0;
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
        bad += !isFinite(hit.p) || !isFinite(hit.ng) || !isFinite(hit.shading.x);
        const auto s = mesh.sample(o, random.bits() % mesh.emitterParts(), {random.uniform(), random.uniform()});
        bad += s && !isFinite(s->p);
    }
    c.measured("hits and samples that are not finite, with empty faces left in", bad, 0);
    int naive = 0;
    for (const auto& t : m.triangles) {
        const Vec3 a = m.positions[t[0]], n = cross(m.positions[t[1]] - a, m.positions[t[2]] - a);
        naive += !isFinite(n * (1 / length(n)));
    }
    c.naive("normals that are not finite by the cross product of two edges", naive);
}

TEST_CASE("case 10: texture coordinates that give no direction") {
    HardCase c;
    MeshData m;
    m.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    m.quads = {{0, 1, 2, 3}};
    struct Textured final : Material {
        Textured() { traits_ = {.usesTextures = true}; }
        const Bsdf* bsdf(const SurfaceHit&, const Wavelengths&, Arena&) const noexcept override { return nullptr; }
    } const textured;
    int bad = 0, naive = 0;
    using Uvs = std::vector<Vec2>;
    for (const Uvs& uvs :
         {Uvs(4), Uvs{{0, 0}, {1, 1}, {2, 2}, {3, 3}}, Uvs{{0, 0}, {1e-30f, 0}, {1e-30f, 1e-30f}, {0, 1e-30f}},
          Uvs{{0, 0}, {1e30f, 0}, {1e30f, 1e30f}, {0, 1e30f}}}) {
        m.uvs = uvs;
        const Mesh mesh(m);
        EmbreeSceneBuilder builder;
        builder.addShape(mesh, {&textured});
        const auto scene = builder.build();
        SurfaceHit hit;
        REQUIRE(scene->intersect({{0.3f, 0.1f, 2}, {0, 0, -1}}, hit));
        hit.arrival = {0, 0, -1};
        hit.footprint = 0.1f;
        const TextureQuery query(hit);
        bad += !isFinite(hit.dpdu) || !isFinite(hit.dpdv) || !isFinite(hit.shading.x);
        for (const float x : {query.du.x, query.du.y, query.dv.x, query.dv.y}) bad += !std::isfinite(x);
        const Vec2 d1 = uvs[1] - uvs[0], d2 = uvs[2] - uvs[0];
        const float det = d1.x * d2.y - d1.y * d2.x;
        naive += !isFinite(((m.positions[1] - m.positions[0]) * d2.y - (m.positions[2] - m.positions[0]) * d1.y) *
                           (1 / det));
    }
    c.measured("derivatives and footprints that are not finite, of four meshes", bad, 0);
    c.naive("of four dp/du by the inverse of the determinant", naive);
}

// In a white furnace a white sphere is invisible. A cosine-weighted direction about a normal that points into it is
// lost.
TEST_CASE("case 11: vertex normals that are zero, inverted, not finite") {
    HardCase c;
    MeshData flipped = icosphere(4, {}, 1);
    flipped.normals = flipped.positions;
    for (std::size_t i = 0; i < flipped.normals.size(); i += 50) flipped.normals[i] = -flipped.normals[i];
    for (std::size_t i = 25; i < flipped.normals.size(); i += 200) flipped.normals[i] = {};
    const Mesh mesh(flipped);
    CHECK(mesh.normalReport().inverted > 0);
    CHECK(mesh.normalReport().missing > 0);
    EmbreeSceneBuilder builder;
    builder.addShape(mesh, {});
    const auto scene = builder.build();
    Random random(6);
    double kept = 0, naive = 0;
    int met = 0, black = 0;
    for (int i = 0; i < 100000; ++i) {
        const Vec3 o(2 * random.uniform() - 1, 2 * random.uniform() - 1, 4);
        SurfaceHit hit;
        if (!scene->intersect({o, {0, 0, -1}}, hit)) continue;
        ++met;
        black += !isFinite(hit.shading.z) || dot(hit.shading.z, hit.ng) < 0;
        const Vec3 w = squareToCosineHemisphere({random.uniform(), random.uniform()});
        kept += dot(hit.shading.toWorld(w), hit.ng) > 0;
        // The vertex normals as they are given.
        const auto& t = flipped.triangles[hit.primitive];
        const Vec2 b = barycentrics(hit.p, flipped.positions[t[0]], flipped.positions[t[1]], flipped.positions[t[2]]);
        const Vec3 n = normalize(flipped.normals[t[0]] * (1 - b.x - b.y) + flipped.normals[t[1]] * b.x +
                                 flipped.normals[t[2]] * b.y);
        naive += isFinite(n) && dot(Frame::fromNormal(n).toWorld(w), hit.ng) > 0;
    }
    c.measured("shading normals that are not finite or point inwards, 2.5 % of the vertices damaged", black, 0);
    c.measured("light that such a white sphere loses in a furnace", 1 - kept / met, 0.01);
    c.naive("normals interpolated as they are", 1 - naive / met);
}

TEST_CASE("case 12: a frame about every direction") {
    HardCase c;
    c.doctor();
    float worst = 0; // of Frisvad's, [Frisvad2012] without its special case
    for (const float x : {1e-5f, 1e-4f, 1e-3f}) {
        const Vec3 n = normalize(Vec3{x, 2 * x, -1});
        const float a = 1 / (1 + n.z), b = -n.x * n.y * a;
        const Vec3 b1{1 - n.x * n.x * a, b, -n.x}, b2{b, 1 - n.y * n.y * a, -n.y};
        worst = std::abs(dot(b1, b2)) <= worst ? worst : std::abs(dot(b1, b2));
    }
    c.naive("dividing by 1 + z", static_cast<double>(worst));
}

TEST_CASE("case 23: more than 2³² primitives or bytes") {
    HardCase c;
    // Counting only: arrays of this size cannot be made in a test.
    int narrow = 0;
    narrow += sizeof(MeshData().triangles.size()) != 8;
    narrow += sizeof(DicingPlan().triangles) != 8 || sizeof(DicingPlan().bytes) != 8;
    narrow += sizeof(DicedSurface::Face().firstQuad) != 8;
    narrow += PixelFilm::memoryBytes({0, 0, 65536, 32768}, 2) != 104ull << 31;
    narrow += sizeof(RawHit().primitive) != 4; // as many as Embree counts in one geometry; cleanMesh refuses more
    c.measured("counts and sizes of fewer than 64 bits", narrow, 0);
    c.naive(
        "bytes of 65536 × 32768 pixels in 32 bits, off by",
        std::abs(static_cast<double>(104ull << 31) - static_cast<double>(static_cast<std::uint32_t>(104ull << 31))));
}
