#include "materials/sheen.h"

#include "math/warp.h"
#include "render/surface_input.h"

#include <cmath>

namespace abbe {
namespace {

// The ground receives what the fuzz lets through, and what it reflects passes: albedo scaling [Kelemen2001;
// Zeltner2022, sec. 5]. Coloured fuzz absorbs the rest of what it caught. On both sides.
class SheenBsdf final : public Bsdf {
  public:
    SheenBsdf(Spectrum color, Spectrum base, float roughness) : color_(color), base_(base), lobe_(roughness) {}

    Lobes lobes() const noexcept override { return kFuzz | kGround; }

    BsdfEval eval(Vec3 wo, Vec3 wi, Transport) const noexcept override {
        if (!(wo.z > 0 ? wi.z > 0 : wo.z < 0 && wi.z < 0)) return {};
        return evalUp(upwards(wo), upwards(wi));
    }

    std::optional<BsdfSample> sample(Vec3 wo, float uLobe, Vec2 u, Transport) const noexcept override {
        if (wo.z == 0) return std::nullopt;
        const Vec3 up = upwards(wo);
        const bool fuzz = uLobe < fuzzChance(lobe_.albedo(up.z));
        Vec3 wi = fuzz ? lobe_.sample(up, u) : squareToCosineHemisphere(u);
        const BsdfEval e = evalUp(up, wi);
        if (!(e.pdfSolidAngle > 0)) return std::nullopt;
        wi.z = std::copysign(wi.z, wo.z);
        return std::optional<BsdfSample>(std::in_place, wi, e.fcos / e.pdfSolidAngle, e.pdfSolidAngle,
                                         fuzz ? kFuzz : kGround);
    }

  private:
    static constexpr Lobes kFuzz = Lobes(Lobe::glossy) | Lobe::reflection;
    static constexpr Lobes kGround = Lobes(Lobe::diffuse) | Lobe::reflection;

    static Vec3 upwards(Vec3 w) { return {w.x, w.y, std::abs(w.z)}; }

    float fuzzChance(float albedo) const {
        const float fuzz = mean(color_) * albedo, ground = mean(base_) * (1 - albedo);
        return fuzz + ground > 0 ? fuzz / (fuzz + ground) : 0;
    }

    BsdfEval evalUp(Vec3 wo, Vec3 wi) const {
        const float albedo = lobe_.albedo(wo.z), chance = fuzzChance(albedo), lambert = cosineHemispherePdf(wi.z);
        const SheenLobe::Value fuzz = lobe_.eval(wo, wi);
        return {color_ * fuzz.fcos + base_ * ((1 - albedo) * lambert), chance * fuzz.pdf + (1 - chance) * lambert};
    }

    Spectrum color_, base_;
    SheenLobe lobe_;
};

class Sheen final : public Material {
  public:
    explicit Sheen(const SheenParams& p)
        : color_(p.color, 1), baseColor_(p.baseColor, 0.2f), roughness_(p.roughness, 0, 1) {
        traits_ = {.isOpaque = true,
                   .focuses = false,
                   .usesTextures = color_.textured() || baseColor_.textured() || roughness_.textured()};
    }

    const Bsdf* bsdf(const SurfaceHit& hit, const Wavelengths& lambda, Arena& arena) const noexcept override {
        return arena.make<SheenBsdf>(color_.at(hit, lambda), baseColor_.at(hit, lambda), roughness_.at(hit));
    }

  private:
    SpectrumInput color_, baseColor_;
    NumberInput roughness_;
};

} // namespace

schema::TypeInfo sheenType() {
    using namespace schema;
    return {.kind = Kind::material,
            .name = "sheen",
            .doc = "Cloth, felt, peach skin, dust: fuzz that brightens towards the rim, on a matte ground.",
            .example = "material velvet sheen { color 0.8; base-color rgb 0.3 0.02 0.05; roughness 0.3 }",
            .fields = {
                field(FieldType::spectrum, "color", &SheenParams::color)
                    .doc("Colour of the fuzz: share that it keeps of the light that it catches.")
                    .example("color rgb 0.9 0.8 0.7")
                    .role(SpectrumRole::albedo)
                    .range(0, 1)
                    .byDefault("1")
                    .synonyms({"sheen_color", "sheenColorFactor", "fuzz_color"}),
                field(FieldType::spectrum, "base-color", &SheenParams::baseColor)
                    .doc("Reflectance of the matte ground; it receives what the fuzz lets through.")
                    .example("base-color rgb 0.3 0.02 0.05")
                    .role(SpectrumRole::albedo)
                    .range(0, 1)
                    .byDefault("0.2")
                    .synonyms({"base_color", "baseColor", "reflectance", "diffuse_color"}),
                field(FieldType::number, "roughness", &SheenParams::roughness)
                    .doc("0: upright fibres, seen at the rim alone; 1: fibres in all directions, as dust.")
                    .example("roughness 0.5")
                    .unit({Dimension::none, Dimension::fraction})
                    .range(0, 1)
                    .byDefault("0.3")
                    .synonyms({"alpha", "sheen_roughness", "sheenRoughnessFactor", "fuzz_roughness"})
                    .note("below 0.02 it is 0.02: perfectly upright fibres throw nothing back"),
            }};
}

std::unique_ptr<const Material> makeSheen(const SheenParams& params) { return std::make_unique<Sheen>(params); }

namespace {

#include "materials/data/sheen_table.inl"

// Cosine and sine of wo's azimuth; any for wo upright.
Vec2 azimuth(Vec3 wo) {
    const float r2 = wo.x * wo.x + wo.y * wo.y;
    if (!(r2 > 1e-30f)) return {1, 0};
    const float scale = 1 / std::sqrt(r2);
    return {wo.x * scale, wo.y * scale};
}

SheenLobe::Entry mix(const SheenLobe::Entry& p, const SheenLobe::Entry& q, float t) {
    return {p.albedo + (q.albedo - p.albedo) * t, p.a + (q.a - p.a) * t, p.b + (q.b - p.b) * t};
}

} // namespace

SheenLobe::SheenLobe(float roughness) {
    const float row = std::clamp(roughness, 0.f, 1.f) * (kRoughnesses - 1);
    row_ = std::min(static_cast<int>(row), kRoughnesses - 2);
    rowShare_ = row - static_cast<float>(row_);
}

SheenLobe::Entry SheenLobe::at(float cosine) const {
    const float column = std::sqrt(std::clamp(cosine, 0.f, 1.f)) * (kCosines - 1);
    const int i = std::min(static_cast<int>(column), kCosines - 2);
    const float t = column - static_cast<float>(i);
    const auto& lower = kSheenTable[row_];
    const auto& upper = kSheenTable[row_ + 1];
    return mix(mix(lower[i], lower[i + 1], t), mix(upper[i], upper[i + 1], t), rowShare_);
}

// The density of M^-1 w on Lambert's lobe, times |M^-1| / |M^-1 w|³ for the change of solid angle [Heitz2016, eq. 1].
SheenLobe::Value SheenLobe::eval(Vec3 wo, Vec3 wi) const {
    if (!(wi.z > 0)) return {};
    const Entry e = at(wo.z);
    const Vec2 c = azimuth(wo);
    const float x = e.a * (c.x * wi.x + c.y * wi.y) + e.b * wi.z, y = e.a * (c.x * wi.y - c.y * wi.x);
    const float length2 = x * x + y * y + wi.z * wi.z;
    const float pdf = wi.z * e.a * e.a / (kPi * length2 * length2);
    return {e.albedo * pdf, pdf};
}

Vec3 SheenLobe::sample(Vec3 wo, Vec2 u) const {
    const Entry e = at(wo.z);
    const Vec2 c = azimuth(wo);
    const Vec3 w = squareToCosineHemisphere(u);
    const float x = (w.x - e.b * w.z) / e.a, y = w.y / e.a;
    return normalize(Vec3{c.x * x - c.y * y, c.y * x + c.x * y, w.z});
}

} // namespace abbe
