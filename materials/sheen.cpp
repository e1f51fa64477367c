#include "materials/sheen.h"

#include "materials/sheen_lobe.h"
#include "math/warp.h"
#include "render/surface_input.h"

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
        : color_(p.color, 1), baseColor_(p.baseColor, 0.2f), roughness_(p.roughness, 0, 1) {}

    const Bsdf* bsdf(const SurfaceHit& hit, const Wavelengths& lambda, Arena& arena) const noexcept override {
        return arena.make<SheenBsdf>(color_.at(hit, lambda), baseColor_.at(hit, lambda), roughness_.at(hit));
    }
    bool isOpaque() const override { return true; }
    bool focuses() const override { return false; }
    bool usesTextures() const override { return color_.textured() || baseColor_.textured() || roughness_.textured(); }

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

} // namespace abbe
