#include "integrators/aim_targets.h"

#include <algorithm>
#include <optional>

namespace abbe {

namespace {

constexpr std::size_t kMost = 24;

Bounds3 inside(const Bounds3& box, const Bounds3& scene) {
    return {max(box.lower, scene.lower), min(box.upper, scene.upper)};
}

// Shapes that lie in the same cell of a grid over the scene, put together.
std::vector<Bounds3> gathered(const std::vector<Bounds3>& boxes, const Bounds3& scene, int cells) {
    std::vector<std::optional<Bounds3>> grid(static_cast<std::size_t>(cells * cells * cells));
    const Vec3 size = scene.diagonal();
    const auto cell = [&](float v, float lower, float width) {
        return width > 0 ? std::clamp(static_cast<int>((v - lower) / width * static_cast<float>(cells)), 0, cells - 1)
                         : 0;
    };
    for (const Bounds3& box : boxes) {
        const Vec3 c = box.centre();
        const int x = cell(c.x, scene.lower.x, size.x), y = cell(c.y, scene.lower.y, size.y),
                  z = cell(c.z, scene.lower.z, size.z);
        auto& place = grid[static_cast<std::size_t>((z * cells + y) * cells + x)];
        if (place)
            place->add(box);
        else
            place = box;
    }
    std::vector<Bounds3> result;
    for (const auto& place : grid)
        if (place) result.push_back(*place);
    return result;
}

} // namespace

std::vector<AimTarget> aimTargets(const std::vector<Bounds3>& focusing, const Bounds3& scene) {
    std::vector<Bounds3> boxes;
    for (const Bounds3& box : focusing) {
        const Bounds3 b = inside(box, scene);
        if (!b.empty()) boxes.push_back(b);
    }
    for (int cells = 16; boxes.size() > kMost && cells > 0; cells /= 2) boxes = gathered(boxes, scene, cells);
    std::vector<AimTarget> targets;
    for (const Bounds3& box : boxes) {
        const float radius = box.radius() * (1 + 1e-4f);
        if (radius > 0) targets.push_back({box.centre(), radius});
    }
    return targets;
}

} // namespace abbe
