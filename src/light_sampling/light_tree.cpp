#include "light_sampling/light_tree.h"

#include "light_sampling/light_tree_builder.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

// What rounding may move a cosine by, with room to spare: nodes within it of their bounds still count.
constexpr float kSlack = 1e-3f;
// Least share of the cosine at receivers that are lit from both sides: hair and cloth go by no cosine.
constexpr float kBothSides = 0.1f;
// Importance stays in a range whose sums and ratios are finite and not 0.
constexpr float kLeastImportance = 1e-30f, kMostImportance = 1e30f;

// The arithmetic of spectra serves any eight numbers.
using Eight = Spectrum;

// cos max(0, a - b) of angles in [0, π] given by cosine and sine.
Eight cosDifference(Eight cosA, Eight sinA, Eight cosB, Eight sinB) {
    return select(cosA.v >= cosB.v, Eight(1.f), fma(cosA, cosB, sinA * sinB));
}
Eight sinDifference(Eight cosA, Eight sinA, Eight cosB, Eight sinB) {
    return select(cosA.v >= cosB.v, Eight(0.f), sinA * cosB - cosA * sinB);
}
Eight sineOf(Eight cosine) { return sqrt(max(Eight(0.f), (Eight(1.f) - cosine) * (Eight(1.f) + cosine))); }
Eight eightOf(const float* values) {
    Float8 result;
    std::copy_n(values, 8, reinterpret_cast<float*>(&result));
    return Eight(result);
}
float sineOf(float cosine) { return std::sqrt(std::max(0.f, (1 - cosine) * (1 + cosine))); }
Eight clamped(Eight x, float least, float most) { return min(max(x, Eight(least)), Eight(most)); }

} // namespace

// Power times the cosines at the node and at the receiver over distance² [ContyEstevez2018, sec. 4.2]. The paper takes
// the best cosines for any point of the bounding sphere, and no distance less than its radius. Here the cosine at the
// receiver is halfway to that of the middle, and the distance² is the mean over the box, d² + r²/3, if it is a cube:
// with eight branches near the receiver, half to a third of the variance. Both are areas, so that the ratio of two
// nodes does not depend on the scene's scale.
template <typename Scatters>
Spectrum LightTree::weigh(const Node& node, const Receiver& at, Scatters&& scatters) noexcept {
    const Eight x = Eight(node.x) - Eight(at.p.x), y = Eight(node.y) - Eight(at.p.y), z = Eight(node.z) - Eight(at.p.z);
    const Eight d2 = fma(x, x, fma(y, y, z * z)), radius2(node.radius2);
    const Eight base = Eight(node.power) / max(fma(radius2, Eight(1.f / 3), d2), Eight(kLeastImportance));
    const Int8 outside = (d2.v > radius2.v) & (d2.v < Eight(kMostImportance).v);
    // What follows is not a number or means nothing for places inside.
    const Eight inverse = Eight(1.f) / sqrt(d2);
    const Eight sin2 = min(Eight(1.f), radius2 * inverse * inverse);
    const Eight sinBall = sqrt(sin2), cosBall = sqrt(Eight(1.f) - sin2);
    Eight factor(1.f);
    if (node.directed) {
        Eight cosine = (x * Eight(node.axisX) + y * Eight(node.axisY) + z * Eight(node.axisZ)) * -inverse;
        cosine = clamped(select(node.twoSided, abs(cosine), cosine), -1, 1);
        const Eight sine = sineOf(cosine);
        const Eight c = cosDifference(cosine, sine, node.cosNormals, node.sinNormals);
        const Eight s = sinDifference(cosine, sine, node.cosNormals, node.sinNormals);
        const Eight best = cosDifference(c, s, cosBall, sinBall);
        factor = select(best.v < node.cosEmission - kSlack, Eight(0.f), max(best, Eight(kSlack)));
        factor = select(node.cosNormals > Eight(-1.f).v, factor, Eight(1.f));
    }
    if (at.surface) {
        const Eight cosineN = (x * at.n.x + y * at.n.y + z * at.n.z) * inverse;
        Eight cosine = at.twoSided ? abs(cosineN) : cosineN;
        cosine = clamped(cosine, -1, 1);
        const Eight best = cosDifference(cosine, sineOf(cosine), cosBall, sinBall);
        const Eight seen = max((best + max(cosine, Eight(0.f))) * 0.5f, Eight(at.twoSided ? kBothSides : kSlack));
        const Eight scattered = scatters(Seen{x * inverse, y * inverse, z * inverse, cosineN, sinBall, sin2, seen});
        factor *= select(best.v < Eight(-kSlack).v, Eight(0.f), scattered);
    }
    factor = select(outside, factor, Eight(1.f));
    const Int8 counts = (factor.v > Eight(0.f).v) & (node.power > Eight(0.f).v);
    return select(counts, clamped(base * factor, kLeastImportance, kMostImportance), Eight(0.f));
}

Spectrum LightTree::importance(const Node& node, const Receiver& at) noexcept {
    return weigh(node, at, [](const Seen& seen) { return seen.matte; });
}

// Times π f cos θi of the lobes, where a matte surface has the cosine.
Spectrum LightTree::importance(const Node& node, const GlossyReceiver& glossy) noexcept {
    return weigh(node, glossy.at(), [&glossy](const Seen& s) {
        const Vec3 w = glossy.wo();
        return glossy.value(s.cosine, s.x * w.x + s.y * w.y + s.z * w.z, s.sine, s.sine2, s.matte);
    });
}

// Over the distance to the ray alone: what a light gives along it, ∫ 1/(D² + t²) dt, is an angle over D.
Spectrum LightTree::importance(const Node& node, const Along& along) noexcept {
    const Vec3 o = along.ray.origin, w = along.ray.direction;
    const Eight x = Eight(node.x) - Eight(o.x), y = Eight(node.y) - Eight(o.y), z = Eight(node.z) - Eight(o.z);
    const Eight t = clamped(x * w.x + y * w.y + z * w.z, along.extent.tNear, along.extent.tFar);
    const Eight dx = x - t * w.x, dy = y - t * w.y, dz = z - t * w.z;
    const Eight d2 = fma(dx, dx, fma(dy, dy, dz * dz));
    const Eight value =
        Eight(node.power) / sqrt(max(fma(Eight(node.radius2), Eight(1.f / 3), d2), Eight(kLeastImportance)));
    return select(node.power > Eight(0.f).v, clamped(value, kLeastImportance, kMostImportance), Eight(0.f));
}

template <typename Place>
Spectrum LightTree::importance(const Node& node, const Place& at, const float* factors) noexcept {
    const Eight parts = importance(node, at);
    return factors ? parts * eightOf(factors) : parts;
}

template <typename Place> Spectrum LightTree::shares(const Node& node, const Place& at, const float* factors) noexcept {
    Eight parts = importance(node, at, factors);
    const float most = maxLane(parts);
    // A light that the receiver all but touches must not round away another one, which may be the one that is seen.
    // Where none can give anything it does not matter.
    if (most > 0)
        parts = select(parts.v > Eight(0.f).v, max(parts, Eight(most * 0x1p-20f)), parts);
    else
        parts = select(node.power > Eight(0.f).v, Eight(1.f), Eight(0.f));
    return parts / sum(parts);
}

template <typename Place>
LightTree::Pick LightTree::pickAt(double u, const Place& at, const float* factors) const noexcept {
    float probability = 1;
    for (const Node* node = nodes_.data();; factors = nullptr) {
        const Eight share = shares(*node, at, factors);
        double before = 0, own = 0;
        std::uint32_t slot = 0;
        for (std::uint32_t i = 0; i < 8; ++i) {
            const float s = share[static_cast<int>(i)];
            if (!(s > 0)) continue; // rounding must not lead where the probability is 0
            slot = i;
            before += own;
            own = static_cast<double>(s);
            if (u < before + own) break;
        }
        u = std::min(std::max(0.0, u - before) / own, 1 - 0x1p-53);
        probability *= static_cast<float>(own);
        if (node->lights >> slot & 1) return {node->next[slot], probability};
        node = &nodes_[node->next[slot]];
    }
}

// From the light up to the root, then down again, so that it rounds as in pickAt.
template <typename Place>
float LightTree::probabilityAt(std::uint32_t light, const Place& at, const float* factors) const noexcept {
    std::array<Branch, light_tree::Builder::kMaxDepth> way;
    std::size_t length = 0;
    for (Branch b = places_[light];; b = nodes_[b.node].parent) {
        way[length++] = b;
        if (b.node == 0) break;
    }
    float probability = 1;
    while (length-- > 0) {
        const Branch b = way[length];
        probability *= shares(nodes_[b.node], at, b.node == 0 ? factors : nullptr)[static_cast<int>(b.slot)];
    }
    return probability;
}

LightTree::Pick LightTree::pick(double u, const Receiver& at, const ScatterView& view,
                                const float* factors) const noexcept {
    return view.glossy() ? pickAt(u, GlossyReceiver(at, view), factors) : pickAt(u, at, factors);
}

float LightTree::probability(std::uint32_t light, const Receiver& at, const ScatterView& view,
                             const float* factors) const noexcept {
    return view.glossy() ? probabilityAt(light, GlossyReceiver(at, view), factors) : probabilityAt(light, at, factors);
}

LightTree::Pick LightTree::pick(double u, const Ray& ray, RayExtent extent) const noexcept {
    return pickAt(u, Along{ray, extent});
}

float LightTree::probability(std::uint32_t light, const Ray& ray, RayExtent extent) const noexcept {
    return probabilityAt(light, Along{ray, extent});
}

// Between a light that emits all around, 1/4π, and one that faces the receiver, 1/π.
float LightTree::irradiance(const Receiver& at, const float* factors) const noexcept {
    return std::min(sum(importance(nodes_[0], at, factors)), kMostImportance) * (0.5f * kInvPi);
}

std::size_t LightTree::branches() const {
    std::size_t count = 0;
    for (int slot = 0; slot < 8; ++slot) count += nodes_[0].power[slot] > 0;
    return count;
}

std::size_t LightTree::branchOf(std::uint32_t light) const {
    Branch at = places_[light];
    while (at.node != 0) at = nodes_[at.node].parent;
    return at.slot;
}

LightTree::LightTree(std::span<const LightBounds> lights, const StopFlag& stop) : places_(lights.size()) {
    light_tree::Builder builder(lights, stop);
    struct Task {
        Branch parent;
        light_tree::Run run;
        int depth;
    };
    std::vector<Task> tasks{{{}, builder.all(), 1}};
    while (!tasks.empty()) {
        const Task task = tasks.back();
        tasks.pop_back();
        const auto index = static_cast<std::uint32_t>(nodes_.size());
        if (index > 0) nodes_[task.parent.node].next[task.parent.slot] = index;
        Node& node = nodes_.emplace_back();
        node.parent = task.parent;
        depth_ = std::max(depth_, task.depth);
        const std::vector<light_tree::Run> branches = builder.branches(task.run);
        for (std::uint32_t slot = 0; slot < branches.size(); ++slot) {
            const light_tree::Run& run = branches[slot];
            assign(node, slot, run.bounds);
            if (run.count > 1) {
                tasks.push_back({{index, slot}, run, task.depth + 1});
                continue;
            }
            node.lights |= static_cast<std::uint8_t>(1u << slot);
            node.next[slot] = builder.light(run.first);
            places_[node.next[slot]] = {index, slot};
        }
    }
}

void LightTree::assign(Node& node, std::uint32_t slot, const LightBounds& b) {
    const Vec3 centre = b.box.centre();
    node.x[slot] = centre.x;
    node.y[slot] = centre.y;
    node.z[slot] = centre.z;
    // Rounded up: the sphere holds the box.
    node.radius2[slot] = square(b.box.radius()) * (1 + 0x1p-20f);
    node.power[slot] = b.power;
    node.axisX[slot] = b.axis.x;
    node.axisY[slot] = b.axis.y;
    node.axisZ[slot] = b.axis.z;
    node.cosNormals[slot] = b.cosNormals;
    node.sinNormals[slot] = sineOf(b.cosNormals);
    node.cosEmission[slot] = b.cosEmission;
    node.twoSided[slot] = b.twoSided ? -1 : 0;
    node.directed |= b.cosNormals > -1;
}

} // namespace abbe
