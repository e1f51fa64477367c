#include "integrators/light_tree.h"

#include "integrators/light_tree_builder.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

// What rounding may move a cosine by, with room to spare: nodes within it of their bounds still count.
constexpr float kSlack = 1e-3f;
// Least share of the cosine at receivers that are lit from both sides: hair and cloth go by no cosine.
constexpr float kBothSides = 0.1f;
// Importance stays in a range whose sums and ratios are finite and not 0.
constexpr float kLeast = 1e-30f, kMost = 1e30f;

// cos max(0, a - b) of angles in [0, π] given by cosine and sine.
float cosDifference(float cosA, float sinA, float cosB, float sinB) {
    return cosA >= cosB ? 1.f : std::fma(cosA, cosB, sinA * sinB);
}
float sinDifference(float cosA, float sinA, float cosB, float sinB) {
    return cosA >= cosB ? 0.f : std::fma(sinA, cosB, -cosA * sinB);
}
float sineOf(float cosine) { return std::sqrt(std::max(0.f, (1 - cosine) * (1 + cosine))); }

} // namespace

// Power times the cosines at the node and at the receiver over distance², all at their best for any point of the
// bounding sphere [ContyEstevez2018, sec. 4.2]. Nearer than the radius the distance means nothing; with the radius² in
// its place, an area too, the ratio of two nodes does not depend on the scene's scale.
float LightTree::importance(const Node& node, const Receiver& at) noexcept {
    const Vec3 way = node.centre - at.p;
    const float d2 = lengthSquared(way);
    const float base = node.power / std::max({d2, node.radius2, kLeast});
    if (!(d2 > node.radius2 && d2 < kMost)) return std::clamp(base, kLeast, kMost);
    const float inverse = 1 / std::sqrt(d2);
    const float sin2 = std::min(1.f, node.radius2 * inverse * inverse), sinBall = std::sqrt(sin2),
                cosBall = std::sqrt(1 - sin2);
    float factor = 1;
    if (node.cosNormals > -1) {
        float cosine = -dot(node.axis, way) * inverse;
        if (node.twoSided) cosine = std::abs(cosine);
        cosine = std::min(cosine, 1.f);
        const float sine = sineOf(cosine);
        const float c = cosDifference(cosine, sine, node.cosNormals, node.sinNormals);
        const float s = sinDifference(cosine, sine, node.cosNormals, node.sinNormals);
        const float least = cosDifference(c, s, cosBall, sinBall);
        if (least < node.cosEmission - kSlack) return 0;
        factor = std::max(least, kSlack);
    }
    if (at.surface) {
        float cosine = dot(at.n, way) * inverse;
        if (at.twoSided) cosine = std::abs(cosine);
        cosine = std::clamp(cosine, -1.f, 1.f);
        const float least = cosDifference(cosine, sineOf(cosine), cosBall, sinBall);
        if (least < -kSlack) return 0;
        factor *= std::max(least, at.twoSided ? kBothSides : kSlack);
    }
    return std::clamp(base * factor, kLeast, kMost);
}

// Over the distance to the ray alone: what a light gives along it, ∫ 1/(D² + t²) dt, is an angle over D.
float LightTree::importance(const Node& node, const Along& along) noexcept {
    const Ray& ray = along.ray;
    const float t = std::clamp(dot(node.centre - ray.origin, ray.direction), along.extent.tNear, along.extent.tFar);
    const float d2 = lengthSquared(node.centre - (ray.origin + ray.direction * t));
    return std::clamp(node.power / std::sqrt(std::max({d2, node.radius2, kLeast})), kLeast, kMost);
}

// Probability of the first child. Where neither can give anything it does not matter. A lamp that the receiver all but
// touches must not round away the other one, which may be the one that is seen.
template <typename Place> float LightTree::firstShare(const Node& parent, const Place& at) const noexcept {
    const float a = importance(nodes_[parent.next], at), b = importance(nodes_[parent.next + 1], at);
    if (!(a > 0 && b > 0)) return a > 0 ? 1.f : b > 0 ? 0.f : 0.5f;
    return std::clamp(a / (a + b), 0x1p-20f, 1 - 0x1p-20f);
}

template <typename Place> LightTree::Pick LightTree::pickAt(double u, const Place& at) const noexcept {
    const Node* node = nodes_.data();
    float probability = 1;
    while (!node->leaf) {
        const float first = firstShare(*node, at);
        const auto share = static_cast<double>(first);
        const bool second = !(u < share);
        u = second ? (u - share) / (1 - share) : u / share;
        // Rounding must not lead where the probability is 0.
        u = std::min(u, 1 - 0x1p-53);
        probability *= second ? 1 - first : first;
        node = &nodes_[node->next + second];
    }
    return {node->next, probability};
}

template <typename Place> float LightTree::probabilityAt(std::uint32_t light, const Place& at) const noexcept {
    const Node* node = nodes_.data();
    float probability = 1;
    for (std::uint64_t trail = trails_[light]; !node->leaf; trail >>= 1) {
        const float first = firstShare(*node, at);
        const bool second = trail & 1;
        probability *= second ? 1 - first : first;
        node = &nodes_[node->next + second];
    }
    return probability;
}

LightTree::Pick LightTree::pick(double u, const Receiver& at) const noexcept { return pickAt(u, at); }

float LightTree::probability(std::uint32_t light, const Receiver& at) const noexcept {
    return probabilityAt(light, at);
}

LightTree::Pick LightTree::pick(double u, const Ray& ray, RayExtent extent) const noexcept {
    return pickAt(u, Along{ray, extent});
}

float LightTree::probability(std::uint32_t light, const Ray& ray, RayExtent extent) const noexcept {
    return probabilityAt(light, Along{ray, extent});
}

// Between a lamp that shines all around, 1/4π, and one that faces the receiver, 1/π.
float LightTree::irradiance(const Receiver& at) const noexcept { return importance(nodes_[0], at) * (0.5f * kInvPi); }

LightTree::LightTree(std::span<const LightBounds> lights) {
    light_tree::Builder builder(lights);
    trails_.resize(lights.size());
    nodes_.reserve(2 * lights.size());
    nodes_.emplace_back();
    struct Task {
        std::uint32_t node, first, count;
        int depth;
        std::uint64_t trail;
    };
    std::vector<Task> tasks{{0, 0, static_cast<std::uint32_t>(lights.size()), 0, 0}};
    while (!tasks.empty()) {
        const Task task = tasks.back();
        tasks.pop_back();
        Node& node = nodes_[task.node];
        assign(node, builder.bounds(task.first, task.count));
        if (task.count == 1) {
            node.leaf = true;
            node.next = builder.light(task.first);
            trails_[node.next] = task.trail;
            depth_ = std::max(depth_, task.depth);
            continue;
        }
        const std::uint32_t left = builder.split(task.first, task.count, task.depth);
        const auto child = static_cast<std::uint32_t>(nodes_.size());
        node.next = child;
        nodes_.emplace_back(); // `node` may be gone from here on
        nodes_.emplace_back();
        tasks.push_back({child + 1, task.first + left, task.count - left, task.depth + 1,
                         task.trail | std::uint64_t{1} << task.depth});
        tasks.push_back({child, task.first, left, task.depth + 1, task.trail});
    }
}

void LightTree::assign(Node& node, const LightBounds& b) {
    node.centre = b.box.centre();
    // Rounded up: the sphere holds the box.
    node.radius2 = square(b.box.radius()) * (1 + 0x1p-20f);
    node.axis = b.axis;
    node.power = b.power;
    node.cosNormals = b.cosNormals;
    node.sinNormals = sineOf(b.cosNormals);
    node.cosEmission = b.cosEmission;
    node.twoSided = b.twoSided;
}

} // namespace abbe
