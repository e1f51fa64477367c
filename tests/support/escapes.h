// Rays from inside a closed mesh: one that meets nothing has found a crack.
#pragma once

#include "geometry/embree_scene_builder.h"
#include "geometry/mesh.h"
#include "support/statistics.h"

#include <utility>

namespace abbe::test {

// How many of `rays` rays in even directions from the middle of the vertices escape. Requires a mesh that is
// star-shaped about it.
inline std::size_t escapes(MeshData closed, std::size_t rays, std::uint64_t seed) {
    Vec3d sum;
    for (const Vec3 p : closed.positions) sum += Vec3d(p);
    const Vec3 inside(sum / static_cast<double>(closed.positions.size()));
    const Mesh mesh(std::move(closed));
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

} // namespace abbe::test
