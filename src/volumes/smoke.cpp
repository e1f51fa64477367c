// A plume of smoke, as it might be at one moment.
#include "volumes/volume_recipe.h"

namespace abbe {

namespace {

// Rises from the origin, leans with the wind, widens as it entrains air.
class Smoke final : public VolumeRecipe {
  public:
    explicit Smoke(std::uint32_t seed) : seed_(mix32(seed ^ 0x50a0eu)) {}

    Bounds3 bounds() const override { return {{-1.7f, 0, -1.7f}, {2.9f, 6, 1.7f}}; }
    std::span<const RecipeField> fields() const override {
        static constexpr RecipeField kSmokeFields[] = {{"density", "", 1}, {"velocity", "m/s", 3}};
        return kSmokeFields;
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

} // namespace

std::unique_ptr<VolumeRecipe> makeSmoke(std::uint32_t seed) { return std::make_unique<Smoke>(seed); }

std::unique_ptr<VolumeRecipe> makeVolumeRecipe(std::string_view kind, std::uint32_t seed) {
    if (kind == "cumulus") return makeCumulus(seed);
    if (kind == "smoke") return makeSmoke(seed);
    if (kind == "fire") return makeFire(seed);
    if (kind == "candle") return makeCandle(seed);
    return nullptr;
}

} // namespace abbe
