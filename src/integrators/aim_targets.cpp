#include "integrators/aim_targets.h"

#include <algorithm>

namespace abbe {

namespace {

constexpr std::size_t kMost = 24;

Bounds3 inside(const Bounds3& box, const Bounds3& scene) {
    return {max(box.lower, scene.lower), min(box.upper, scene.upper)};
}

// What is aimed at as one.
struct Cluster {
    static constexpr std::size_t kNamed = 3;

    Bounds3 box;
    std::vector<std::string> names; // each once, kNamed at most
    bool more = false;              // than are named

    void add(const Cluster& c) {
        box.add(c.box);
        more |= c.more;
        for (const std::string& name : c.names) {
            if (std::ranges::find(names, name) != names.end()) continue;
            if (names.size() < kNamed)
                names.push_back(name);
            else
                more = true;
        }
    }
    std::string text() const {
        std::string text;
        for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
        return more ? text + " and others" : text;
    }
};

// Shapes that lie in the same cell of a grid over the scene, put together.
std::vector<Cluster> gathered(const std::vector<Cluster>& shapes, const Bounds3& scene, int cells) {
    std::vector<Cluster> grid(static_cast<std::size_t>(cells * cells * cells));
    const Vec3 size = scene.diagonal();
    const auto cell = [&](float v, float lower, float width) {
        return width > 0 ? std::clamp(static_cast<int>((v - lower) / width * static_cast<float>(cells)), 0, cells - 1)
                         : 0;
    };
    for (const Cluster& shape : shapes) {
        const Vec3 c = shape.box.centre();
        const int x = cell(c.x, scene.lower.x, size.x), y = cell(c.y, scene.lower.y, size.y),
                  z = cell(c.z, scene.lower.z, size.z);
        grid[static_cast<std::size_t>((z * cells + y) * cells + x)].add(shape);
    }
    std::erase_if(grid, [](const Cluster& c) { return c.box.empty(); });
    return grid;
}

} // namespace

AimTargets aimTargets(const std::vector<FocusingShape>& focusing, const Bounds3& scene) {
    std::vector<Cluster> shapes;
    for (const FocusingShape& shape : focusing) {
        const Bounds3 b = inside(shape.box, scene);
        if (!b.empty()) shapes.push_back({b, {shape.name}, false});
    }
    for (int cells = 16; shapes.size() > kMost && cells > 0; cells /= 2) shapes = gathered(shapes, scene, cells);
    AimTargets targets;
    for (const Cluster& shape : shapes) {
        const float radius = shape.box.radius() * (1 + 1e-4f);
        if (!(radius > 0)) continue;
        targets.balls.push_back({shape.box.centre(), radius});
        targets.names.push_back(shape.text());
    }
    return targets;
}

} // namespace abbe
