#include "transport/surroundings.h"

#include <algorithm>
#include <array>
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
    std::array<SurfaceHit, 4> others;
    std::vector<const Material*> entered;
    std::vector<SurfaceHit> left; // without having been entered: the innermost first
    const auto pass = [&](const SurfaceHit& face) {
        if (!fills(*face.material)) return;
        if (dot(ray.direction, face.ng) < 0)
            entered.push_back(face.material);
        else if (const auto own = std::find(entered.rbegin(), entered.rend(), face.material); own != entered.rend())
            entered.erase(std::next(own).base());
        else
            left.push_back(face);
    };
    for (int i = 0; i < kMaxCrossings && scene.intersector->intersect(ray, hit); ++i) {
        pass(hit);
        const std::size_t count = scene.nested ? scene.intersector->coincident(ray, hit, others) : 0;
        for (std::size_t k = 0; k < count; ++k) pass(others[k]);
        leaveBeyond(hit, std::span(others).first(count));
        ray.origin = spawnOrigin(hit, ray.direction);
    }
    // The innermost was entered last.
    for (auto shape = left.rbegin(); shape != left.rend(); ++shape) around.cross(*shape, -ray.direction);
    return around;
}

} // namespace abbe
