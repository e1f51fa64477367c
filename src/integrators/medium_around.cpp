#include "integrators/medium_around.h"

namespace abbe {

MediumStack mediaAround(const Scene& scene, Vec3 point, float time) {
    constexpr int kMaxCrossings = 1000;
    MediumStack around, entered;
    if (!scene.interiors) return around;
    // No axis of anything that is likely to be modelled.
    Ray ray{point, normalize(Vec3{0.2673f, 0.8018f, 0.5345f}), kInfinity, time};
    SurfaceHit hit;
    for (int i = 0; i < kMaxCrossings && scene.intersector->intersect(ray, hit); ++i) {
        const Medium* medium = hit.material->interior();
        if (medium && dot(ray.direction, hit.ng) < 0) {
            entered.enter(medium);
        } else if (medium) {
            const int before = entered.size();
            entered.leave(medium);
            if (entered.size() == before) around.enter(medium);
        }
        ray.origin = spawnOrigin(hit, ray.direction);
    }
    return around;
}

} // namespace abbe
