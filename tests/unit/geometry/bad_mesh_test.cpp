// Random meshes, most of them damaged: an error that says what is wrong, or a surface that rays and samples can meet.
#include "geometry/embree_scene_builder.h"
#include "geometry/mesh.h"
#include "support/nightly.h"
#include "support/statistics.h"

#include <cstdlib>
#include <doctest/doctest.h>
#include <limits>

namespace abbe {
namespace {

using test::Random;

int tries() { return test::nightly() ? 10'000 : 1000; }

// Sizes from 1e-30 to 1e15 m, flat and coinciding vertices, indices out of range, numbers that are none.
MeshData randomMesh(Random& random) {
    MeshData mesh;
    const auto number = [&] { return 2 * random.uniform() - 1; };
    const auto vector = [&] { return Vec3{number(), number(), number()}; };
    const std::uint32_t vertices = 1 + random.bits() % 12;
    const float size = std::pow(10.f, static_cast<float>(random.bits() % 46) - 30);
    for (std::uint32_t v = 0; v < vertices; ++v) {
        Vec3 p = random.bits() % 3 ? vector() : Vec3{1, 2, 3} * number(); // on one line
        if (random.bits() % 8 == 0) p.z = 0;
        if (v > 0 && random.bits() % 8 == 0) p = mesh.positions[random.bits() % v] * (1 / size);
        mesh.positions.push_back(p * size);
    }
    if (random.bits() % 3 == 0)
        for (std::uint32_t v = 0; v < vertices; ++v)
            mesh.normals.push_back(random.bits() % 4 ? vector() : vector() * (random.bits() % 2 ? 0.f : 1e30f));
    if (random.bits() % 3 == 0)
        for (std::uint32_t v = 0; v < vertices; ++v) mesh.uvs.push_back({number(), random.bits() % 4 ? number() : 0.f});
    const std::uint32_t range = vertices + (random.bits() % 16 == 0 ? 1 : 0);
    const auto index = [&] { return random.bits() % range; };
    for (std::uint32_t f = random.bits() % 8; f > 0; --f) mesh.triangles.push_back({index(), index(), index()});
    for (std::uint32_t f = random.bits() % 8; f > 0; --f) mesh.quads.push_back({index(), index(), index(), index()});
    if (random.bits() % 32 == 0) mesh.positions[random.bits() % vertices].y = std::numeric_limits<float>::quiet_NaN();
    if (random.bits() % 32 == 0) mesh.positions[random.bits() % vertices].x = kInfinity;
    if (random.bits() % 32 == 0) mesh.normals.emplace_back();
    if (random.bits() % 32 == 0) mesh.uvs.resize(1);
    return mesh;
}

bool isUnit(Vec3 v) { return std::abs(length(v) - 1) < 1e-3f; }

// Rays from all sides at the vertices and between them. Returns how many met something.
int shootAt(const Mesh& mesh, Random& random) {
    EmbreeSceneBuilder builder;
    builder.addShape(mesh, {});
    const auto scene = builder.build();
    const Bounds3 box = mesh.bounds();
    const Vec3 middle = (box.lower + box.upper) * 0.5f;
    const float reach = std::max(length(box.upper - box.lower), 1e-20f);
    int met = 0;
    for (int i = 0; i < 8; ++i) {
        const Vec3 way = normalize(Vec3{random.uniform() - 0.5f, random.uniform() - 0.5f, random.uniform() - 0.4999f});
        const Vec3 at =
            random.bits() % 2 ? middle : mesh.data().positions[random.bits() % mesh.data().positions.size()];
        SurfaceHit hit;
        if (scene->intersect({at - way * reach, way}, hit)) {
            ++met;
            CHECK((isFinite(hit.p) && isUnit(hit.ng) && isUnit(hit.shading.x) && isUnit(hit.shading.z)));
            CHECK(dot(hit.shading.z, hit.ng) >= 0);
        }
        scene->occluded({at - way * reach, way});
        if (const auto s = mesh.sample(middle + way * reach, random.bits() % mesh.emitterParts(),
                                       {random.uniform(), random.uniform()}))
            CHECK((isFinite(s->p) && s->pdfSolidAngle > 0));
    }
    return met;
}

} // namespace

TEST_CASE("mesh: random meshes, sound or not, do no harm" * doctest::test_suite("input")) {
    Random random(123);
    int refused = 0, met = 0;
    for (int i = 0; i < tries(); ++i) {
        MeshData data = randomMesh(random);
        const MeshCleanup cleanup = cleanMesh(data);
        if (cleanup.error) CHECK_FALSE(cleanup.error->empty());
        refused += cleanup.error.has_value();
        if (cleanup.error || (data.triangles.empty() && data.quads.empty())) continue;
        INFO("mesh " << i);
        met += shootAt(Mesh(std::move(data)), random);
    }
    CHECK(refused > tries() / 10);
    CHECK(met > tries() / 2);
}

} // namespace abbe
