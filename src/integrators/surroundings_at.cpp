#include "integrators/surroundings_at.h"

#include <algorithm>
#include <vector>

namespace abbe {

namespace {

// Only closed shapes can contain anything.
bool fills(const Material& material) { return material.ior() || material.interior(); }

} // namespace

Surroundings surroundingsAt(const Scene& scene, Vec3 point, float time) {
    constexpr int kMaxCrossings = 1000;
    Surroundings around;
    // No axis of anything that is likely to be modelled.
    Ray ray{point, normalize(Vec3{0.2673f, 0.8018f, 0.5345f}), kInfinity, time};
    SurfaceHit hit;
    std::vector<const Material*> entered;
    std::vector<SurfaceHit> left; // without having been entered: the innermost first
    for (int i = 0; i < kMaxCrossings && scene.intersector->intersect(ray, hit); ++i) {
        if (fills(*hit.material)) {
            if (dot(ray.direction, hit.ng) < 0)
                entered.push_back(hit.material);
            else if (const auto own = std::find(entered.rbegin(), entered.rend(), hit.material); own != entered.rend())
                entered.erase(std::next(own).base());
            else
                left.push_back(hit);
        }
        ray.origin = spawnOrigin(hit, ray.direction);
    }
    // The innermost was entered last.
    for (auto shape = left.rbegin(); shape != left.rend(); ++shape) around.cross(*shape, -ray.direction);
    return around;
}

} // namespace abbe
