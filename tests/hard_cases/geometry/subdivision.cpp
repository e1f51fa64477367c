// Subdivision surfaces, polygons, displacement and curves: cases 13 to 16 and 22 of docs/hard_cases.md.
#include "geometry/curves.h"
#include "geometry/embree_scene_builder.h"
#include "geometry/mesh.h"
#include "geometry/subdivision_surface.h"
#include "hard_cases/hard_case.h"
#include "io/mesh_file.h"
#include "support/scene_test.h"
#include "support/subdivision_cages.h"
#include "support/subdivision_reference.h"

using namespace abbe;
using namespace abbe::test;

namespace {

constexpr std::uint64_t kPlenty = 1ull << 33;

MeshData dice(const SubdivisionCage& cage, double level) {
    REQUIRE(findFault(cage) == std::nullopt);
    const SubdivisionSurface surface(cage);
    return surface.dice(surface.plan({Dicing::Mode::level, level, {}}, kPlenty)).mesh;
}

// The same mesh with the normals of its facets, averaged at the vertices.
MeshData withFacetNormals(MeshData m) {
    std::vector<Vec3> sums(m.positions.size());
    const auto add = [&](std::span<const std::uint32_t> f) {
        for (std::size_t i = 1; i + 1 < f.size(); ++i) {
            const Vec3 a = m.positions[f[0]], n = cross(m.positions[f[i]] - a, m.positions[f[i + 1]] - a);
            for (const std::uint32_t v : f) sums[v] += n;
        }
    };
    for (const auto& t : m.triangles) add(t);
    for (const auto& q : m.quads) add(q);
    for (std::size_t v = 0; v < sums.size(); ++v) m.normals[v] = normalize(sums[v]);
    return m;
}

} // namespace

TEST_CASE("case 13: extraordinary points of subdivision") {
    HardCase c;
    double worst = 0, naive = 0;
    for (const std::uint32_t valence : {3u, 4u, 5u, 6u, 7u, 8u, 16u, 33u, 64u}) {
        const SubdivisionCage cage = domeCage(valence);
        const MeshData diced = dice(cage, 3);
        const Agreement a = compareWithReference(cage, diced, 3, 3);
        CHECK(a.distance < 1e-4);
        worst = std::max(worst, a.worstSmooth);
        naive = std::max(naive, compareWithReference(cage, withFacetNormals(diced), 3, 3).worstSmooth);
    }
    c.measured("largest error of a normal of domes of valence 3 to 64, degrees", worst, 0.5);
    c.naive("normals averaged over the facets", naive);
}

TEST_CASE("case 14: creases, darts, corners of subdivision") {
    HardCase c;
    const MeshData m = dice(creasedCube(10), 3);
    const auto worst = [](const MeshData& mesh) {
        double largest = 0;
        for (std::size_t i = 0; i < mesh.quads.size(); ++i) {
            const std::size_t face = i / 64;
            Vec3 outward;
            (face / 2 == 0 ? outward.z : face / 2 == 1 ? outward.y : outward.x) = face % 2 ? 1.f : -1.f;
            for (const std::uint32_t v : mesh.quads[i]) {
                const double off = static_cast<double>(length(mesh.normals[v] - outward));
                largest = off <= largest ? largest : off;
            }
        }
        return largest;
    };
    REQUIRE(m.quads.size() == 6 * 64);
    c.measured("largest difference of a normal of a cube with infinitely sharp edges from the face's", worst(m), 1e-3);
    MeshData joined = m; // one vertex for both sides of a crease
    std::map<std::array<float, 3>, std::uint32_t> places;
    for (auto& q : joined.quads)
        for (auto& v : q)
            v = places.try_emplace({m.positions[v].x, m.positions[v].y, m.positions[v].z}, v).first->second;
    c.naive("one normal for both sides of a crease", worst(withFacetNormals(joined)));
}

// Polygons of any form, most of them bad: an error, or triangles whose indices are those of the polygon.
TEST_CASE("case 15: concave, bent, overlapping polygons") {
    HardCase c;
    Random random(15);
    int bad = 0, kept = 0;
    for (int i = 0; i < 10000; ++i) {
        MeshData mesh;
        const auto number = [&] { return 2 * random.uniform() - 1; };
        const std::uint32_t vertices = 1 + random.bits() % 12;
        const float size = std::pow(10.f, static_cast<float>(random.bits() % 46) - 30);
        for (std::uint32_t v = 0; v < vertices; ++v) {
            Vec3 p = random.bits() % 3 ? Vec3(number(), number(), number()) : Vec3(1, 2, 3) * number();
            if (v > 0 && random.bits() % 8 == 0) p = mesh.positions[random.bits() % v] * (1 / size);
            mesh.positions.push_back(p * size);
        }
        const std::uint32_t range = vertices + (random.bits() % 16 == 0 ? 1 : 0);
        const auto index = [&] { return random.bits() % range; };
        for (std::uint32_t f = random.bits() % 8; f > 0; --f) mesh.triangles.push_back({index(), index(), index()});
        for (std::uint32_t f = random.bits() % 8; f > 0; --f)
            mesh.quads.push_back({index(), index(), index(), index()});
        if (random.bits() % 32 == 0) mesh.positions[0].y = std::numeric_limits<float>::quiet_NaN();
        if (cleanMesh(mesh).error || mesh.triangles.size() + mesh.quads.size() == 0) continue;
        ++kept;
        const Mesh surface(mesh);
        EmbreeSceneBuilder builder;
        builder.addShape(surface, {});
        const auto scene = builder.build();
        const Vec3 way = normalize(Vec3{number(), number(), 1.1f}), at = mesh.positions[random.bits() % vertices];
        const float reach = std::max(length(surface.bounds().upper - surface.bounds().lower), 1e-20f);
        SurfaceHit hit;
        if (scene->intersect({at - way * reach, way}, hit))
            bad += !isFinite(hit.p) || !(std::abs(length(hit.ng) - 1) < 1e-3f) || !(dot(hit.shading.z, hit.ng) >= 0);
    }
    CHECK(kept > 2000);
    c.measured("of 1e4 random meshes, most of them damaged, hits without a point or a normal; no crash", bad, 0);
    // A concave quadrilateral: the fan from its first corner covers ground outside, counted twice.
    const Vec2 arrow[] = {{0, 0}, {2, 1}, {0, 2}, {1, 1}}; // its area is 1
    double fan = 0;
    for (int i = 1; i < 3; ++i) {
        const Vec2 a = arrow[i] - arrow[0], b = arrow[i + 1] - arrow[0];
        fan += std::abs(static_cast<double>(a.x * b.y - a.y * b.x)) / 2;
    }
    MeshData mesh;
    mesh.positions = {{0, 0, 0}, {2, 1, 0}, {0, 2, 0}, {1, 1, 0}};
    REQUIRE(addPolygon(mesh, std::array<std::uint32_t, 4>{0, 1, 2, 3}));
    const double area = Mesh(mesh).area();
    c.measured("relative error of the area of a concave quadrilateral", std::abs(area - 1), 1e-6);
    c.naive("a fan of triangles", std::abs(fan - 1));
}

// Clear glass of smooth normals in a white sky is invisible, whatever its form: lossless, and n² cancels. Folds run
// through each other.
TEST_CASE("case 16: displacement that overlaps itself") {
    HardCase c;
    const TestScene scene = TestScene::parse(
        "scene 1\nfilm { size 8 8; filter box 0.5 }\ncamera { from 0 0 4; look-at 0 0 0; fov 30 deg }\n"
        "light sky { radiance 1 }\nshape subdivision {\n"
        "  points { - -1 -1 -1; - 1 -1 -1; - -1 1 -1; - 1 1 -1; - -1 -1 1; - 1 -1 1; - -1 1 1; - 1 1 1 }\n"
        "  faces { - 0 2 3 1; - 4 5 7 6; - 0 1 5 4; - 2 6 7 3; - 0 4 6 2; - 1 3 7 5 }\n"
        "  dicing 6\n  displacement 0.3 { map noise { scale 0.25; octaves 2 } }\n"
        "  material dielectric { ior 1.5 } }\n");
    REQUIRE_MESSAGE(!scene.diagnostics().hasErrors(), scene.report());
    const TestImage image = render(scene, 256);
    double sum = 0;
    for (int i = 0; i < 64; ++i) sum += image.film.mean(i % 8, i / 8).y / 64;
    CHECK(image.statistics.dropped == std::array<std::uint64_t, 3>{});
    c.measured("light lost or gained by displaced glass in a white sky", std::abs(sum - 1), 0.01);
}

TEST_CASE("case 22: curves with cusps or no width") {
    HardCase c;
    int bad = 0, met = 0;
    Random random(9);
    const auto inCube = [&] { return Vec3(random.uniform(), random.uniform(), random.uniform()) * 2 - Vec3(1, 1, 1); };
    for (const CurveBasis basis : {CurveBasis::linear, CurveBasis::bspline, CurveBasis::catmullRom, CurveBasis::bezier})
        for (const CurveForm form : {CurveForm::round, CurveForm::flat}) {
            CurveData data{basis, form, {}, {}};
            const std::uint32_t count = leastPoints(basis) + 3 * pointStep(basis);
            for (int i = 0; i < 1000; ++i) {
                std::vector<SizedPoint> strand;
                Vec3 p = inCube() * 0.2f;
                for (std::uint32_t k = 0; k < count; ++k) strand.push_back({p += normalize(inCube()) * 0.2f, 0.02f});
                if (i % 100 == 1) // all in one place
                    for (SizedPoint& q : strand) q.position = strand[0].position;
                if (i % 100 == 2) strand[2].position = strand[1].position;
                if (i % 100 == 3) strand[3].position = strand[1].position; // there and back: a cusp
                if (i % 100 == 4)
                    for (SizedPoint& q : strand) q.radius = 0;
                data.points.insert(data.points.end(), strand.begin(), strand.end());
                data.strandSizes.push_back(count);
            }
            const Curves curves(std::move(data));
            CHECK(curves.omittedSegments() > 0);
            EmbreeSceneBuilder builder;
            builder.addShape(curves, {});
            const auto scene = builder.build();
            for (int i = 0; i < 20000; ++i) {
                SurfaceHit hit;
                const Vec3 o = normalize(inCube()) * 9.f, target = inCube() * 0.5f;
                if (!scene->intersect({o, normalize(target - o)}, hit)) continue;
                ++met;
                bad += !isFinite(hit.p) || !(std::abs(length(hit.ng) - 1) < 1e-3f) ||
                       !(std::abs(length(hit.shading.x) - 1) < 1e-3f) || !std::isfinite(hit.uv.x);
            }
        }
    CHECK(met > 20000);
    c.measured("hits on hairballs with 4 % of bad strands that have no point or frame", bad, 0);
    const Vec3 cusp[] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {1, 0, 0}}; // Bézier: the derivative at 0 is 3 (p1 - p0)
    const Vec3 tangent = (cusp[1] - cusp[0]) * 3;
    c.naive("tangent at a doubled end", static_cast<double>((tangent * (1 / length(tangent))).x));
}
