#include "light_sampling/light_tree_builder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

namespace abbe::light_tree {

namespace {

constexpr int kBins = 12;

double angleOf(float cosine) { return std::acos(std::clamp(static_cast<double>(cosine), -1.0, 1.0)); }

// Turns the unit vector `a` towards `b` by an angle.
Vec3d turned(Vec3d a, Vec3d b, double angle) {
    Vec3d side = b - a * dot(a, b);
    // Opposite axes: any way round will do.
    if (!(lengthSquared(side) > 1e-12)) side = std::abs(a.x) < 0.7 ? cross(a, {1, 0, 0}) : cross(a, {0, 1, 0});
    return a * std::cos(angle) + normalize(side) * std::sin(angle);
}

// Whether the cone of half angle b about an axis at an angle to that of a is within a, without trigonometry. May say
// no where it just is.
bool isWithin(double cosA, double cosBetween, double cosB) {
    const double sines = std::sqrt(std::max(0.0, 1 - cosBetween * cosBetween) * std::max(0.0, 1 - cosB * cosB));
    return cosBetween + cosB > 0 && cosBetween * cosB - sines >= cosA;
}

// The narrowest cone around two cones of normals. Of double cones either axis will do.
void mergeNormals(const LightBounds& a, const LightBounds& b, LightBounds& out) {
    const LightBounds& wide = a.cosNormals <= b.cosNormals ? a : b;
    const LightBounds& narrow = &wide == &a ? b : a;
    const Vec3d axis(wide.axis),
        to = Vec3d(narrow.axis) * (out.twoSided && dot(wide.axis, narrow.axis) < 0 ? -1.0 : 1.0);
    out.axis = wide.axis;
    out.cosNormals = wide.cosNormals;
    if (wide.cosNormals <= -1) return;
    if (isWithin(static_cast<double>(wide.cosNormals), dot(axis, to), static_cast<double>(narrow.cosNormals))) return;
    const double half = angleOf(wide.cosNormals), other = angleOf(narrow.cosNormals);
    const double between = std::atan2(length(cross(axis, to)), dot(axis, to));
    if (std::min(between + other, kPiD) <= half) return;
    const double angle = (half + between + other) / 2;
    if (angle >= kPiD) {
        out.cosNormals = -1;
        return;
    }
    out.cosNormals = static_cast<float>(std::cos(angle));
    out.axis = Vec3(normalize(turned(axis, to, angle - half)));
}

// Solid angle that light may leave into, with a cosine at its rim [ContyEstevez2018, eq. 1].
double orientation(const LightBounds& b) {
    const double o = angleOf(b.cosNormals), w = std::min(o + angleOf(b.cosEmission), kPiD);
    const double single = 2 * kPiD * (1 - std::cos(o)) +
                          kPiD / 2 * (2 * w * std::sin(o) - std::cos(o - 2 * w) - 2 * o * std::sin(o) + std::cos(o));
    return b.twoSided ? std::min(2 * single, 4 * kPiD) : single;
}

struct Bin {
    LightBounds bounds;
    std::uint32_t count = 0;

    void add(const LightBounds& b, std::uint32_t n) {
        if (n == 0) return;
        bounds = count > 0 ? merged(bounds, b) : b;
        count += n;
    }
};

float along(Vec3 v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

int binOf(float x, float lower, float width) {
    return std::clamp(static_cast<int>(static_cast<float>(kBins) * ((x - lower) / width)), 0, kBins - 1);
}

struct Division {
    double cost;
    int bin; // the last of the first half
};

// The cheapest place between two bins; nothing if all lights are in one.
std::optional<Division> cheapest(const std::array<Bin, kBins>& bins) {
    std::array<double, kBins> after{};
    Bin sum;
    for (int i = kBins - 1; i > 0; --i) {
        sum.add(bins[i].bounds, bins[i].count);
        after[i - 1] = sum.count > 0 ? cost(sum.bounds) : -1;
    }
    std::optional<Division> best;
    sum = {};
    for (int i = 0; i + 1 < kBins; ++i) {
        sum.add(bins[i].bounds, bins[i].count);
        if (sum.count == 0 || after[i] < 0) continue;
        const double c = cost(sum.bounds) + after[i];
        if (!best || c < best->cost) best = Division{c, i};
    }
    return best;
}

} // namespace

LightBounds merged(const LightBounds& a, const LightBounds& b) {
    LightBounds out = a;
    out.box.add(b.box);
    out.power = a.power + b.power;
    out.cosEmission = std::min(a.cosEmission, b.cosEmission);
    out.twoSided = a.twoSided || b.twoSided;
    mergeNormals(a, b, out);
    return out;
}

double cost(const LightBounds& b) {
    const Vec3d d(b.box.diagonal());
    // Points and lines have no surface, but do have an extent.
    const double surface = 2 * (d.x * d.y + d.y * d.z + d.z * d.x) + 0.01 * lengthSquared(d);
    return static_cast<double>(b.power) * surface * orientation(b);
}

Builder::Builder(std::span<const LightBounds> lights, const StopFlag& stop)
    : lights_(lights), stop_(stop), order_(lights.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
}

Run Builder::run(std::uint32_t first, std::uint32_t count, int depth) const {
    Run r{first, count, depth, lights_[order_[first]]};
    if (toldToStop()) return r;
    for (std::uint32_t i = 1; i < count; ++i) r.bounds = merged(r.bounds, lights_[order_[first + i]]);
    return r;
}

// Again and again the dearest to look into; of lights in one place, which cost nothing, the most.
std::vector<Run> Builder::branches(const Run& whole) {
    std::vector<Run> runs{whole};
    const auto dearer = [](const Run& a, const Run& b) {
        if ((a.count > 1) != (b.count > 1)) return a.count > 1;
        const double costA = cost(a.bounds), costB = cost(b.bounds);
        return costA != costB ? costA > costB : a.count > b.count;
    };
    while (runs.size() < kBranches) {
        const auto found = std::min_element(runs.begin(), runs.end(), dearer);
        const Run dearest = *found;
        if (dearest.count == 1) break;
        const std::uint32_t left = split(dearest);
        *found = run(dearest.first, left, dearest.depth + 1);
        runs.push_back(run(dearest.first + left, dearest.count - left, dearest.depth + 1));
    }
    return runs;
}

std::uint32_t Builder::split(const Run& whole) {
    const std::uint32_t first = whole.first, count = whole.count;
    if (toldToStop()) return count / 2;
    const int depth = whole.depth;
    const auto begin = order_.begin() + first, end = begin + count;
    const auto middle = [&](std::uint32_t i) { return lights_[i].box.centre(); };
    Bounds3 centres;
    for (auto i = begin; i != end; ++i) centres.add(middle(*i));
    const Vec3 extent = centres.diagonal();
    const float longest = maxComponent(extent);

    std::optional<Division> best;
    int bestAxis = 0;
    // Near the limit of depth halves are a must: 2^32 lights take 32 steps.
    for (int axis = 0; axis < 3 && depth < kMaxDepth - 33; ++axis) {
        const float lower = along(centres.lower, axis), width = along(extent, axis);
        if (!(width > 0)) continue;
        std::array<Bin, kBins> bins;
        for (auto i = begin; i != end; ++i) bins[binOf(along(middle(*i), axis), lower, width)].add(lights_[*i], 1);
        auto division = cheapest(bins);
        if (!division) continue;
        division->cost *= static_cast<double>(longest / width); // against thin slices
        if (!best || division->cost < best->cost) {
            best = division;
            bestAxis = axis;
        }
    }
    if (!best) return count / 2;
    const float lower = along(centres.lower, bestAxis), width = along(extent, bestAxis);
    const auto cut = std::stable_partition(
        begin, end, [&](std::uint32_t i) { return binOf(along(middle(i), bestAxis), lower, width) <= best->bin; });
    const auto left = static_cast<std::uint32_t>(cut - begin);
    return left > 0 && left < count ? left : count / 2;
}

} // namespace abbe::light_tree
