// Flames as they might be at one moment: a fire over a round bed, and that of a candle.
#include "volumes/volume_recipe.h"

namespace abbe {

namespace {

constexpr RecipeField kFlameFields[] = {{"density", "", 1}, {"temperature", "K", 1}, {"flame", "", 1}};

// Two metres high: sheets of glowing soot that are torn into tongues as they rise, and smoke above.
class Fire final : public VolumeRecipe {
  public:
    explicit Fire(std::uint32_t seed) : seed_(mix32(seed ^ 0xf17eu)) {}

    Bounds3 bounds() const override { return {{-0.75f, 0, -0.75f}, {0.75f, 2.2f, 0.75f}}; }
    std::span<const RecipeField> fields() const override { return kFlameFields; }
    bool leaf(Vec3 corner, float size, RecipeLeaf& out) const override { return eachVoxel(*this, corner, size, out); }

    bool voxel(Vec3 p, float* values) const {
        const float across = std::hypot(p.x, p.z);
        if (p.y < 0 || p.y > 2.2f || across > 0.75f) return false;
        // Gas is faster higher up: what it carries is stretched, and swings wider.
        const float wild = 0.05f + 0.22f * smoothStep(0, 1.4f, p.y);
        const Vec3 slow = fractalVector(Vec3(p.x * 1.8f, p.y * 1.1f, p.z * 1.8f), 3, seed_ + 1);
        const Vec3 q = p + Vec3(slow.x, 0.5f * slow.y, slow.z) * (2 * wild);
        const float rise = std::pow(std::max(q.y, 0.f), 0.8f);
        const float tongues = fractalNoise(Vec3(q.x * 5.5f, rise * 1.7f, q.z * 5.5f), 4, seed_ + 2);
        const float height = std::clamp(q.y / 1.9f, 0.f, 1.f);
        const float radius = 0.4f * std::pow(1 - height, 0.7f) * (0.72f + 0.28f * smoothStep(0, 0.25f, q.y));
        const float distance = std::hypot(q.x, q.z);
        const float inside = radius - distance + (0.1f + 0.6f * height) * tongues - 0.12f * height;
        const float body = smoothStep(0, 0.1f, inside) * smoothStep(0, 0.06f, p.y);
        // Soot glows in folded sheets about where fuel and air meet; between them the flame is thin.
        const float fold = fractalNoise(Vec3(q.x * 4.2f, rise * 1.3f, q.z * 4.2f) + slow * 0.6f, 4, seed_ + 3);
        const float sheet = 1 - smoothStep(0.01f, 0.17f, std::abs(fold));
        const float rim = 1 - smoothStep(0.02f, 0.2f, inside);
        const float flame = body * (0.06f + 0.94f * std::max(sheet, 0.4f * rim)) * (1 - smoothStep(1.6f, 2.05f, p.y));
        const float column = smoothStep(0, 0.3f, 0.24f - distance + 0.8f * tongues);
        const float soot = column * smoothStep(0.9f, 1.9f, p.y) * (1 - smoothStep(1.9f, 2.18f, p.y)) * 0.3f;
        if (!(flame > 1e-3f) && !(soot > 1e-3f)) return false;
        // Sheets burn at about 1800 K and lose heat, by radiation above all, on their way up and at the edges.
        const float cooled =
            0.28f * smoothStep(0.1f, 1.8f, p.y) + 0.16f * (1 - smoothStep(0, 0.5f, body)) - 0.05f * sheet;
        values[0] = std::max(soot * (1 - 0.6f * body), 0.25f * flame);
        values[1] = body > 1e-3f ? 1780 * (1 - cooled) : 300 + 250 * column;
        values[2] = flame;
        return true;
    }

  private:
    std::uint32_t seed_;
};

// Three centimetres high over a wick at the origin: a dark zone of fuel around the wick, a bright body of soot, and the
// thin hot sheet where it burns.
class Candle final : public VolumeRecipe {
  public:
    explicit Candle(std::uint32_t seed) : seed_(mix32(seed ^ 0xca17u)) {}

    Bounds3 bounds() const override { return {{-0.008f, -0.003f, -0.008f}, {0.008f, 0.034f, 0.008f}}; }
    std::span<const RecipeField> fields() const override { return kFlameFields; }
    bool leaf(Vec3 corner, float size, RecipeLeaf& out) const override { return eachVoxel(*this, corner, size, out); }

    bool voxel(Vec3 p, float* values) const {
        const float h = (p.y + kBelow) / (kTop + kBelow); // 0 at the foot, 1 at the tip
        if (h <= 0 || h >= 1) return false;
        // The tip leans with the draught, and how depends on the seed.
        const Vec3 lean = fractalVector({0.3f, 0.7f, 0.1f}, 2, seed_);
        const float bend = 0.004f * h * h;
        const float across = std::hypot(p.x - lean.x * bend, p.z - lean.z * bend);
        const float radius = kRadius * profile(h);
        const float inside = (radius - across) / kRadius; // 0 at the surface
        const float body = smoothStep(0, 0.35f, inside);
        if (!(inside > 0)) return false;
        const float low = smoothStep(0.08f, 0.42f, h), fuel = 1 - smoothStep(0.15f, 0.55f, h);
        const float core = smoothStep(0.35f, 0.8f, inside);
        const float glow = body * low * (1 - 0.75f * fuel * core) * (1 - 0.5f * smoothStep(0.75f, 1, h));
        const float flame = std::max(glow, 0.02f * body);
        values[0] = 0.2f * flame;
        // 1900 K in the sheet, 1650 in the soot, cooler around the wick and at the tip.
        const float sheet = 1 - smoothStep(0.1f, 0.45f, inside);
        values[1] = 1620 + 230 * sheet * low - 420 * fuel * core - 140 * smoothStep(0.6f, 1, h);
        values[2] = flame;
        return true;
    }

  private:
    static constexpr float kEnd = 0.879f; // of the step below at 1
    static constexpr float kBelow = 0.002f, kTop = 0.033f, kRadius = 0.0055f;
    // Of the outline: round below, widest at a third, drawn out to a point.
    static float profile(float h) {
        const float foot = std::sqrt(1 - square(1 - std::min(h / 0.32f, 1.f)));
        return foot * std::pow(1 - smoothStep(0.1f, 1.25f, h) / kEnd, 0.9f);
    }
    std::uint32_t seed_;
};

} // namespace

std::unique_ptr<VolumeRecipe> makeFire(std::uint32_t seed) { return std::make_unique<Fire>(seed); }
std::unique_ptr<VolumeRecipe> makeCandle(std::uint32_t seed) { return std::make_unique<Candle>(seed); }

} // namespace abbe
