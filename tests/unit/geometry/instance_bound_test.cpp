// The error bounds of instances hold, and are not far above what rounding does.
#include "geometry/embree_scene_builder.h"
#include "geometry/flat_shapes.h"
#include "support/statistics.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

using test::Random;

Transform randomMap(Random& random) {
    const auto number = [&] { return 2.0 * random.uniform() - 1; };
    Transform m;
    for (auto& row : m.a)
        for (double& v : row) v = number();
    m.t = Vec3d{number(), number(), number()} * 30;
    return m;
}

} // namespace

// What has to be cleared is the error of the point and the rounding of the next ray in object space, together.
TEST_CASE("instances: the next ray's origin keeps to the surface within a bound that is no thirty times too wide") {
    const Vec3 corner(-9, -8, 3), across(17, 1, 5), up(2, 15, -4);
    const Quad quad(corner, corner + across, corner + across + up, corner + up);
    const Vec3d normal = normalize(cross(Vec3d(across), Vec3d(up)));
    Random random(17);
    double worst = 0;
    int hits = 0;
    for (int i = 0; i < 3000; ++i) {
        const Placement placement(randomMap(random));
        const Transform map = placement.map();
        if (Placement::findFault(map)) continue;
        EmbreeSceneBuilder builder;
        builder.addInstance(builder.addObject({{&quad, {}}}), map);
        const auto scene = builder.build();
        for (int k = 0; k < 8; ++k) {
            const Vec3d to = map.point(Vec3d(corner + across * random.uniform() + up * random.uniform()));
            const Vec3 from(to + Vec3d{random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5} * 40);
            SurfaceHit hit;
            if (!scene->intersect({from, normalize(Vec3(to) - from)}, hit)) continue;
            ++hits;
            const Vec3d inside(placement.toObject(Ray{hit.p, {0, 0, 1}}).origin);
            // A distance d from the plane in object space is d over this outside.
            const Vec3d n = map.normal(normal) * (1 / std::abs(map.determinant()));
            const double off = std::abs(dot(inside - Vec3d(corner), normal)) / length(n);
            worst = std::max(worst, off / dot(Vec3d(hit.pError), abs(normalize(n))));
        }
    }
    CHECK(hits > 10000);
    CHECK(worst <= 1);
    CHECK(worst > 0.033);
}

} // namespace abbe
