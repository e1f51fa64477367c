// No ray leaves a closed diced surface from inside.
#include "geometry/embree_scene.h"
#include "geometry/mesh.h"
#include "geometry/subdivision_surface.h"
#include "support/statistics.h"
#include "support/subdivision_cages.h"

#include <cstdlib>
#include <doctest/doctest.h>

using namespace abbe;
using namespace abbe::test;

namespace {

// A point well inside, as all of these cages are star-shaped about their middle.
Vec3 middle(const MeshData& m) {
    Vec3d sum;
    for (const Vec3 p : m.positions) sum += Vec3d(p);
    return Vec3(sum / static_cast<double>(m.positions.size()));
}

std::size_t escapes(MeshData diced, std::size_t rays, std::uint64_t seed) {
    const Vec3 inside = middle(diced);
    const Mesh mesh(std::move(diced));
    EmbreeSceneBuilder builder;
    builder.addShape(mesh, {});
    const auto scene = builder.build();
    Random random(seed);
    std::size_t escaped = 0;
    for (std::size_t i = 0; i < rays; ++i) {
        Vec3 d;
        do d = {2 * random.uniform() - 1, 2 * random.uniform() - 1, 2 * random.uniform() - 1};
        while (lengthSquared(d) > 1 || lengthSquared(d) < 1e-4f);
        SurfaceHit hit;
        escaped += !scene->intersect({inside, normalize(d)}, hit);
    }
    return escaped;
}

} // namespace

TEST_CASE("subdivision: no ray leaves a closed surface") {
    const std::size_t rays = std::getenv("ABBE_NIGHTLY") ? 1'000'000 : 20'000;
    for (const auto& [name, cage, closed] : namedCages()) {
        if (!closed) continue;
        CAPTURE(name);
        const SubdivisionSurface surface(cage);
        for (const double length : {0.3, 0.1, 0.03}) {
            const DicingPlan plan = surface.plan({Dicing::Mode::length, length, {}}, 1ull << 32);
            CHECK(escapes(surface.dice(plan).mesh, rays, 5) == 0);
        }
    }
}
