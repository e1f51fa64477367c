// A plume of smoke and a flame, as they might be at one moment.
#include "volumes/noise.h"
#include "volumes/volume_recipe.h"

namespace abbe {

namespace {

// A recipe that computes each voxel by itself; `Voxel` sets all components at a place.
template <typename Recipe> bool eachVoxel(const Recipe& recipe, Vec3 corner, float size, RecipeLeaf& out) {
    bool any = false;
    float values[6];
    for (std::size_t i = 0; i < RecipeLeaf::kVoxels; ++i) {
        const Vec3 p = corner + Vec3(float(i >> 6), float(i >> 3 & 7), float(i & 7)) * size;
        const bool here = recipe.voxel(p, values);
        any = any || here;
        for (std::size_t c = 0; c < out.components.size(); ++c) out.components[c][i] = here ? values[c] : 0;
    }
    return any;
}

// Rises from the origin, leans with the wind, widens as it entrains air.
class Smoke final : public VolumeRecipe {
  public:
    explicit Smoke(std::uint32_t seed) : seed_(mix32(seed ^ 0x50a0eu)) {}

    Bounds3 bounds() const override {
        Bounds3 b;
        b.add({-1.7f, 0, -1.7f});
        b.add({2.9f, 6, 1.7f});
        return b;
    }
    std::span<const RecipeField> fields() const override {
        static constexpr RecipeField kFields[] = {{"density", "", 1}, {"velocity", "m/s", 3}};
        return kFields;
    }
    bool leaf(Vec3 corner, float size, RecipeLeaf& out) const override {
        const float margin = 8 * size;
        const float y = corner.y + margin;
        if (y < 0) return false;
        const Vec3 axis = axisAt(corner.y);
        const float reach = 3.2f * radiusAt(y) + margin * 1.8f;
        if (std::abs(corner.x - axis.x) > reach || std::abs(corner.z) > reach) return false;
        return eachVoxel(*this, corner, size, out);
    }

    bool voxel(Vec3 p, float* values) const {
        if (p.y < 0 || p.y > 6) return false;
        // Similar at every height: lengths are measured in radii, along the axis too (the integral of dy / radius).
        const float r = radiusAt(p.y);
        const Vec3 axis = axisAt(p.y);
        const Vec3 s((p.x - axis.x) / r, std::log(r) / kWidening, p.z / r);
        const Vec3 swirl = fractalVector(s * 0.45f, 2, seed_ + 1);
        const Vec3 curl = fractalVector(s * 1.1f + swirl, 3, seed_ + 2);
        const Vec3 q = s + swirl * 1.5f + curl * 0.7f;
        const float distance = std::hypot(q.x, q.z);
        const float puffs =
            0.6f - cellularNoise(q * 0.9f, seed_ + 3) + 0.5f * (0.6f - cellularNoise(q * 2.1f, seed_ + 4));
        const float wisps = fractalNoise(q * 1.7f, 5, seed_ + 5);
        const float shape = 1 - distance + 0.8f * puffs + 0.7f * wisps;
        const float ends = smoothStep(0, 0.12f, p.y) * (1 - smoothStep(4.4f, 5.9f, p.y + 0.6f * swirl.x));
        // The same smoke in an ever wider column: 1 at the mouth.
        const float thin = radiusAt(0) * radiusAt(0) / (r * r);
        const float density = smoothStep(0.05f, 0.7f, shape) * ends * std::pow(thin, 0.6f);
        if (!(density > 1e-3f)) return false;
        values[0] = density;
        const float rise = 2.4f / (1 + 0.35f * p.y) * (1.15f - 0.5f * std::min(distance, 1.5f));
        values[1] = 0.24f * p.y + 0.8f * curl.x;
        values[2] = std::max(0.05f, rise + 0.8f * curl.y);
        values[3] = 0.8f * curl.z;
        return true;
    }

  private:
    static constexpr float kWidening = 0.15f;
    static float radiusAt(float y) { return 0.11f + kWidening * std::max(y, 0.f); }
    static Vec3 axisAt(float y) { return {0.045f * y * std::abs(y), y, 0}; }
    std::uint32_t seed_;
};

// A flame over a round bed, two metres high, with soot above it.
class Fire final : public VolumeRecipe {
  public:
    explicit Fire(std::uint32_t seed) : seed_(mix32(seed ^ 0xf17eu)) {}

    Bounds3 bounds() const override {
        Bounds3 b;
        b.add({-0.75f, 0, -0.75f});
        b.add({0.75f, 2.2f, 0.75f});
        return b;
    }
    std::span<const RecipeField> fields() const override {
        static constexpr RecipeField kFields[] = {{"density", "", 1}, {"temperature", "K", 1}, {"flame", "", 1}};
        return kFields;
    }
    bool leaf(Vec3 corner, float size, RecipeLeaf& out) const override { return eachVoxel(*this, corner, size, out); }

    bool voxel(Vec3 p, float* values) const {
        if (p.y < 0 || p.y > 2.2f || std::hypot(p.x, p.z) > 0.75f) return false;
        // Gas is faster higher up: tongues are stretched and flicker more there.
        const float wild = 0.06f + 0.4f * smoothStep(0, 1.3f, p.y);
        const Vec3 warp = fractalVector(Vec3(p.x * 2.2f, p.y * 1.2f, p.z * 2.2f), 3, seed_ + 1);
        const Vec3 q = p + Vec3(warp.x, 0.4f * warp.y, warp.z) * wild;
        const float tongues = fractalNoise(Vec3(q.x * 6, q.y * 1.5f, q.z * 6), 4, seed_ + 2);
        const float height = q.y / 1.5f;
        const float radius = 0.4f * (1 - smoothStep(-0.1f, 1.05f, height)) * (0.7f + 0.3f * smoothStep(0, 0.2f, q.y));
        const float distance = std::hypot(q.x, q.z);
        const float flame = smoothStep(0, 0.13f, radius - distance + (0.12f + 0.55f * height) * tongues) *
                            smoothStep(0, 0.05f, p.y) * (1 - smoothStep(1.5f, 1.9f, p.y));
        const float column = smoothStep(0, 0.3f, 0.22f - distance + 0.8f * tongues);
        const float soot = column * smoothStep(0.8f, 1.9f, p.y) * (1 - smoothStep(1.85f, 2.18f, p.y)) * 0.35f;
        if (!(flame > 1e-3f) && !(soot > 1e-3f)) return false;
        // Hottest in the reaction zone, low and towards the rim; cooling as it rises.
        const float hot = flame * (1.f - 0.33f * smoothStep(0.2f, 1.5f, p.y) + 0.1f * tongues);
        values[0] = std::max(soot * (1 - 0.6f * flame), 0.25f * flame);
        values[1] = 300 + 1650 * std::clamp(hot, 0.f, 1.05f) + 250 * column * (1 - flame);
        values[2] = flame;
        return true;
    }

  private:
    std::uint32_t seed_;
};

} // namespace

std::unique_ptr<VolumeRecipe> makeSmoke(std::uint32_t seed) { return std::make_unique<Smoke>(seed); }
std::unique_ptr<VolumeRecipe> makeFire(std::uint32_t seed) { return std::make_unique<Fire>(seed); }

std::unique_ptr<VolumeRecipe> makeVolumeRecipe(std::string_view kind, std::uint32_t seed) {
    if (kind == "cumulus") return makeCumulus(seed);
    if (kind == "smoke") return makeSmoke(seed);
    if (kind == "fire") return makeFire(seed);
    return nullptr;
}

} // namespace abbe
