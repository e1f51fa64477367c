#include "caustics/shared/aim_targets.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace abbe {

namespace {

constexpr std::size_t kMostTargets = 24;

Bounds3 inside(const Bounds3& box, const Bounds3& scene) {
    return {max(box.lower, scene.lower), min(box.upper, scene.upper)};
}

// What is aimed at as one.
struct Cluster {
    static constexpr std::size_t kNamed = 3;

    Bounds3 box;
    std::vector<std::string> names; // each once, kNamed at most
    bool more = false;              // than are named
    bool round = false;             // one shape, a ball

    // Of the ball to aim at, m.
    float radius() const { return round ? 0.5f * maxComponent(box.diagonal()) : box.radius(); }
    void add(const Cluster& c) {
        round = box.empty() && c.round;
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

// Shapes tell no more than their boxes and areas. By Cauchy's formula the mean shadow of a convex body is a quarter of
// its area: in a box that is a cube, with a shadow as large as the disk in it, a ball. Were it something else, its
// corners would be left to the share of light paths that is not aimed: no picture depends on it.
bool isBall(const Shape& shape) {
    constexpr float kCube = 1e-4f;
    constexpr double kArea = 1e-3; // of what is nearly a ball, such as a fine mesh
    const Vec3 size = shape.bounds().diagonal();
    const float most = maxComponent(size), least = std::min({size.x, size.y, size.z});
    if (!(least > 0) || !std::isfinite(most) || most - least > kCube * most) return false;
    return std::abs(shape.area() / (kPiD * square(static_cast<double>(most))) - 1) < kArea;
}

using BoxKey = std::array<float, 6>;
BoxKey keyOf(const Bounds3& b) { return {b.lower.x, b.lower.y, b.lower.z, b.upper.x, b.upper.y, b.upper.z}; }

} // namespace

std::vector<Bounds3> boxesOfBalls(std::span<const SurfaceUse> surfaces) {
    std::vector<Bounds3> boxes;
    for (const SurfaceUse& use : surfaces)
        if (!use.insideObject && isBall(*use.shape)) boxes.push_back(use.shape->bounds());
    return boxes;
}

AimTargets aimTargets(const std::vector<FocusingShape>& focusing, const Bounds3& scene,
                      std::span<const Bounds3> round) {
    std::vector<BoxKey> balls;
    for (const Bounds3& box : round) balls.push_back(keyOf(box));
    std::ranges::sort(balls);
    std::vector<Cluster> shapes;
    for (const FocusingShape& shape : focusing) {
        const Bounds3 b = inside(shape.box, scene);
        // What lies in part beyond the scene's box is not a ball any more.
        if (!b.empty()) shapes.push_back({b, {shape.name}, false, std::ranges::binary_search(balls, keyOf(b))});
    }
    for (int cells = 16; shapes.size() > kMostTargets && cells > 0; cells /= 2) shapes = gathered(shapes, scene, cells);
    AimTargets targets;
    for (const Cluster& shape : shapes) {
        const float radius = shape.radius() * (1 + 1e-4f);
        if (!(radius > 0)) continue;
        targets.balls.push_back({shape.box.centre(), radius});
        targets.names.push_back(shape.text());
    }
    return targets;
}

} // namespace abbe
