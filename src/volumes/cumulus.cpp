// A cumulus: billows upon billows on a flat base.
#include "volumes/noise.h"
#include "volumes/volume_recipe.h"

#include <algorithm>

namespace abbe {

namespace {

constexpr float kBase = 60;    // height of the lower boundary, m
constexpr float kWidth = 1000; // of the whole, m

struct CloudSphere {
    Vec3 centre;
    float radius = 0;
};

// Random numbers in a fixed order.
class Draw {
  public:
    explicit Draw(std::uint32_t seed) : state_(seed) {}
    float unit() { return unitFloat(mix32(state_ += 0x9e3779b9u)); }
    float within(float a, float b) { return a + (b - a) * unit(); }
    // On the unit sphere, not below y.
    Vec3 direction(float lowestY) {
        const float y = within(lowestY, 1), r = safeSqrt(1 - y * y), angle = 2 * kPi * unit();
        return {r * std::cos(angle), y, r * std::sin(angle)};
    }

  private:
    std::uint32_t state_;
};

// Turrets along the middle, highest there; on each smaller ones, three generations.
std::vector<CloudSphere> billows(std::uint32_t seed) {
    Draw draw(seed);
    std::vector<CloudSphere> all;
    for (int i = 0; i < 11; ++i) {
        const float along = (static_cast<float>(i) + draw.within(-0.3f, 0.3f)) / 10 * 2 - 1; // -1 … 1
        const float height = 1 - along * along;
        const float radius = draw.within(62, 92) * (0.7f + 0.5f * height);
        all.push_back({{along * 330, kBase + radius * draw.within(0.25f, 0.5f) + height * draw.within(20, 190),
                        draw.within(-130, 130) * (0.35f + height)},
                       radius});
        all.push_back(
            {{along * 330 + draw.within(-40, 40), kBase + radius * 0.3f, draw.within(-90, 90)}, radius * 0.95f});
    }
    std::size_t first = 0;
    const int children[] = {10, 8, 7};
    for (const int count : children) {
        const std::size_t last = all.size();
        for (std::size_t parent = first; parent < last; ++parent)
            for (int i = 0; i < count; ++i) {
                const CloudSphere p = all[parent];
                const float radius = p.radius * draw.within(0.3f, 0.52f);
                all.push_back({p.centre + draw.direction(-0.35f) * (p.radius * draw.within(0.82f, 1.f)), radius});
            }
        first = last;
    }
    std::erase_if(all, [](const CloudSphere& s) { return s.centre.y + s.radius < kBase; });
    return all;
}

class Cumulus final : public VolumeRecipe {
  public:
    explicit Cumulus(std::uint32_t seed) : seed_(mix32(seed ^ 0xc10d5u)), spheres_(billows(seed_)) {
        for (const CloudSphere& s : spheres_) {
            bounds_.add(s.centre - Vec3(1, 1, 1) * (s.radius + kReach));
            bounds_.add(s.centre + Vec3(1, 1, 1) * (s.radius + kReach));
        }
        bounds_.lower.y = std::max(bounds_.lower.y, kBase - kReach);
        // Scaled to the same width for every seed.
        scale_ = kWidth / std::max(bounds_.diagonal().x, bounds_.diagonal().z);
        bin();
    }

    Bounds3 bounds() const override { return {bounds_.lower * scale_, bounds_.upper * scale_}; }
    std::span<const RecipeField> fields() const override {
        static constexpr RecipeField kCumulusFields[] = {{"density", "", 1}};
        return kCumulusFields;
    }

    bool leaf(Vec3 corner, float size, RecipeLeaf& out) const override {
        corner = corner / scale_;
        size /= scale_;
        const Vec3 centre = corner + Vec3(3.5f, 3.5f, 3.5f) * size;
        const float radius = 6.1f * size;
        if (centre.y + radius < kBase - kReach) return false;
        Near near;
        gather(centre, radius, near);
        if (near.spheres.empty()) return false;
        bool any = false;
        auto& values = out.components[0];
        for (int i = 0; i < RecipeLeaf::kVoxels; ++i) {
            const Vec3 p = corner + Vec3(float(i >> 6), float(i >> 3 & 7), float(i & 7)) * size;
            const float v = density(p, near, size);
            values[static_cast<std::size_t>(i)] = v;
            any = any || v > 0;
        }
        return any;
    }

  private:
    static constexpr float kReach = 14; // displaced surfaces lie that far beyond the spheres at most, m
    static constexpr float kBin = 40;

    struct Near {
        std::vector<CloudSphere> spheres;
        bool inside = false; // all of the leaf is deep in a sphere
    };

    int binOf(Vec3 p, int axis) const {
        return std::clamp(static_cast<int>((p[axis] - bounds_.lower[axis]) / kBin), 0, count_[axis] - 1);
    }
    std::size_t binIndex(int x, int y, int z) const {
        return static_cast<std::size_t>((x * count_[1] + y) * count_[2] + z);
    }
    void bin() {
        for (int a = 0; a < 3; ++a) count_[a] = 1 + static_cast<int>(bounds_.diagonal()[a] / kBin);
        bins_.resize(binIndex(count_[0] - 1, count_[1] - 1, count_[2] - 1) + 1);
        for (std::uint32_t i = 0; i < spheres_.size(); ++i) {
            const Vec3 r = Vec3(1, 1, 1) * (spheres_[i].radius + kReach), c = spheres_[i].centre;
            for (int x = binOf(c - r, 0); x <= binOf(c + r, 0); ++x)
                for (int y = binOf(c - r, 1); y <= binOf(c + r, 1); ++y)
                    for (int z = binOf(c - r, 2); z <= binOf(c + r, 2); ++z) bins_[binIndex(x, y, z)].push_back(i);
        }
    }

    void gather(Vec3 centre, float radius, Near& near) const {
        std::vector<std::uint32_t> found;
        const Vec3 r = Vec3(1, 1, 1) * radius;
        for (int x = binOf(centre - r, 0); x <= binOf(centre + r, 0); ++x)
            for (int y = binOf(centre - r, 1); y <= binOf(centre + r, 1); ++y)
                for (int z = binOf(centre - r, 2); z <= binOf(centre + r, 2); ++z) {
                    const auto& bin = bins_[binIndex(x, y, z)];
                    found.insert(found.end(), bin.begin(), bin.end());
                }
        std::sort(found.begin(), found.end());
        found.erase(std::unique(found.begin(), found.end()), found.end());
        for (const std::uint32_t i : found) {
            const float distance = length(centre - spheres_[i].centre) - spheres_[i].radius;
            if (distance > radius + kReach) continue;
            if (distance < -(radius + kDeep)) near.inside = true;
            near.spheres.push_back(spheres_[i]);
        }
    }

    static constexpr float kDeep = 40; // the noise reaches no deeper, m

    // Signed distance to the union of spheres, below 0 inside; rounded where they meet.
    static float distance(Vec3 p, const Near& near) {
        float d = 1e9f;
        for (const CloudSphere& s : near.spheres) {
            const float next = length(p - s.centre) - s.radius;
            const float k = 0.12f * s.radius, h = std::max(k - std::abs(d - next), 0.f);
            d = std::min(d, next) - h * h / (4 * k);
        }
        return d;
    }

    float density(Vec3 p, const Near& near, float size) const {
        const float body = 0.8f + 0.25f * gradientNoise(p / 90, seed_ + 7);
        const float bottom = kBase + 9 * gradientNoise(Vec3(p.x, 0, p.z) / 60, seed_ + 3) +
                             3 * gradientNoise(p / 14, seed_ + 4) - p.y; // crisp but uneven
        if (near.inside && bottom < -8) return body;
        float d = distance(p, near);
        if (d > kReach || bottom > 8) return 0;
        if (d > -kDeep) {
            // Cauliflower: round bulges of cells between sharp creases, smaller ones on larger, warped a little.
            const Vec3 q = p + fractalVector(p / 45, 2, seed_ + 11) * 16;
            const float high = smoothStep(kBase, kBase + 110, p.y);
            d -= (0.35f + 0.65f * high) * 15 * (0.62f - cellularNoise(q / 34, seed_ + 1));
            d -= (0.4f + 0.6f * high) * 7 * (0.62f - cellularNoise(q / 14, seed_ + 2));
            if (size < 6) d -= 3.2f * (0.62f - cellularNoise(q / 6, seed_ + 5));
            // Edges are eaten away by evaporation, below and at the sides more than at the rising tops.
            d += (1 - 0.7f * high) * 9 * std::max(0.f, fractalNoise(p / 22, 3, seed_ + 6) + 0.1f);
        }
        const float edge = std::max(5.f, 1.5f * size);
        return body * smoothStep(0, edge, -d) * smoothStep(0, std::max(7.f, 1.5f * size), -bottom);
    }

    std::uint32_t seed_;
    std::vector<CloudSphere> spheres_;
    Bounds3 bounds_;
    float scale_ = 1;
    int count_[3] = {};
    std::vector<std::vector<std::uint32_t>> bins_;
};

} // namespace

std::unique_ptr<VolumeRecipe> makeCumulus(std::uint32_t seed) { return std::make_unique<Cumulus>(seed); }

} // namespace abbe
