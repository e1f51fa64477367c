// No ray leaves a closed surface from inside: all closed ones of the reference cages, at three rates of dicing. A
// million rays each at night (docs/testing.md).
#include "geometry/embree_scene_builder.h"
#include "geometry/mesh.h"
#include "geometry/subdivision_surface.h"
#include "io/mesh_file.h"
#include "support/nightly.h"
#include "support/statistics.h"
#include "support/subdivision_reference.h"

#include <doctest/doctest.h>
#include <filesystem>

using namespace abbe;
using namespace abbe::test;

namespace {

const std::filesystem::path kCrackFolder = std::filesystem::path(ABBE_SOURCE_DIR) / "../shared/data/subdivision";

// Every edge joins two faces that run against each other, and no face is left out.
bool isClosed(const SubdivisionCage& cage) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    std::size_t first = 0;
    for (const std::uint32_t n : cage.faceSizes) {
        for (std::uint32_t i = 0; i < n; ++i)
            if (++edges[{cage.corners[first + i], cage.corners[first + (i + 1) % n]}] > 1) return false;
        first += n;
    }
    for (const auto& [e, count] : edges)
        if (!edges.contains({e.second, e.first})) return false;
    return cage.holes.empty();
}

Vec3 direction(Random& random) {
    Vec3 d;
    do d = {2 * random.uniform() - 1, 2 * random.uniform() - 1, 2 * random.uniform() - 1};
    while (lengthSquared(d) > 1 || lengthSquared(d) < 1e-4f);
    return normalize(d);
}

// The middle of the longest way from a face straight inwards to the other side, among some.
Vec3 inside(const Intersector& scene, const MeshData& m) {
    Vec3 best;
    float longest = 0;
    const auto look = [&](Vec3 from, Vec3 n) {
        if (!(lengthSquared(n) > 0)) return;
        const Vec3 inwards = -normalize(n);
        SurfaceHit hit;
        if (!scene.intersect({from + inwards * 1e-5f, inwards}, hit) || hit.distance <= longest) return;
        longest = hit.distance;
        best = from + inwards * (0.5f * hit.distance);
    };
    const std::vector<Vec3>& p = m.positions;
    for (std::size_t i = 0; i < m.quads.size(); i += 1 + m.quads.size() / 50) {
        const auto& q = m.quads[i];
        look((p[q[0]] + p[q[1]] + p[q[2]] + p[q[3]]) * 0.25f, cross(p[q[2]] - p[q[0]], p[q[3]] - p[q[1]]));
    }
    for (std::size_t i = 0; i < m.triangles.size(); i += 1 + m.triangles.size() / 50) {
        const auto& t = m.triangles[i];
        look((p[t[0]] + p[t[1]] + p[t[2]]) * (1 / 3.f), cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]));
    }
    CHECK(longest > 0);
    return best;
}

std::size_t escapes(MeshData diced, std::size_t rays, std::uint64_t seed) {
    const Mesh mesh(std::move(diced));
    EmbreeSceneBuilder builder;
    builder.addShape(mesh, {});
    const auto scene = builder.build();
    const Vec3 from = inside(*scene, mesh.data());
    Random random(seed);
    std::size_t escaped = 0;
    for (std::size_t i = 0; i < rays; ++i) {
        SurfaceHit hit;
        escaped += !scene->intersect({from, direction(random)}, hit);
    }
    return escaped;
}

} // namespace

TEST_CASE("subdivision: no ray leaves a closed reference cage") {
    if (!std::filesystem::exists(kCrackFolder)) return;
    const std::size_t rays = test::nightly() ? 1'000'000 : 1000;
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(kCrackFolder))
        if (entry.path().extension() == ".obj") files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    std::size_t closed = 0, all = 0;
    for (const auto& path : files) {
        const std::string name = path.stem().string();
        CAPTURE(name);
        SubdivisionCage cage = readObjCage(path.string()).cage;
        cage.scheme = name.starts_with("loop")       ? SubdivisionCage::Scheme::loop
                      : name.starts_with("bilinear") ? SubdivisionCage::Scheme::bilinear
                                                     : SubdivisionCage::Scheme::catmullClark;
        if (findFault(cage) || !isClosed(cage)) continue;
        const SubdivisionSurface surface(cage);
        const double size = sizeOf(cage);
        if (name.find("val2") != std::string::npos) continue; // two faces back to back: nothing inside
        ++closed;
        for (const double part : {0.05, 0.02, 0.007}) {
            CAPTURE(part);
            const DicingPlan plan = surface.plan({Dicing::Mode::length, part * size, {}, {}}, 1ull << 30);
            const std::size_t escaped = escapes(surface.dice(plan).mesh, rays, closed);
            CHECK(escaped == 0);
            all += escaped;
        }
        if (rays > 1000) MESSAGE(name << ": " << rays << " rays at each of 3 rates, " << all << " escaped so far");
    }
    CHECK(closed > 20);
    MESSAGE(closed << " closed cages, " << rays << " rays at each of 3 rates, " << all << " escaped");
}
