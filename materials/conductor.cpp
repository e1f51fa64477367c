#include "materials/conductor.h"

#include "base/check.h"
#include "materials/fresnel.h"
#include "materials/ggx.h"
#include "materials/ggx_albedo.h"

namespace abbe {
namespace {

class SmoothConductorBsdf final : public Bsdf {
  public:
    SmoothConductorBsdf(Spectrum n, Spectrum k) : n_(n), k_(k) {}

    Lobes lobes() const noexcept override { return Lobes(Lobe::delta) | Lobe::reflection; }
    BsdfEval eval(Vec3, Vec3, Transport) const noexcept override { return {}; }
    std::optional<BsdfSample> sample(Vec3 wo, float, Vec2, Transport) const noexcept override {
        if (wo.z == 0) return std::nullopt;
        return std::optional<BsdfSample>(std::in_place, Vec3{-wo.x, -wo.y, wo.z},
                                         fresnelConductor(std::abs(wo.z), n_, k_), 1.f, lobes());
    }

  private:
    Spectrum n_, k_;
};

// Two-sided: directions below the surface are mirrored to +z first.
class RoughConductorBsdf final : public Bsdf {
  public:
    RoughConductorBsdf(Spectrum n, Spectrum k, Ggx ggx)
        : n_(n), k_(k), normalReflectance_(fresnelConductor(1, n, k)), ggx_(ggx) {}

    Lobes lobes() const noexcept override { return Lobes(Lobe::glossy) | Lobe::reflection; }

    BsdfEval eval(Vec3 wo, Vec3 wi, Transport) const noexcept override {
        if (wo.z < 0) wo.z = -wo.z, wi.z = -wi.z;
        if (!(wo.z > 0 && wi.z > 0)) return {};
        const Vec3 h = normalize(wo + wi); // both z > 0: never 0
        const float d = ggx_.D(h);
        return {reflectance(wo, h) * (0.25f * d * ggx_.maskingOverCosine(wo, wi)), ggx_.boundedReflection(wo) * d};
    }

    std::optional<BsdfSample> sample(Vec3 wo, float, Vec2 u, Transport) const noexcept override {
        const bool below = wo.z < 0;
        if (below) wo.z = -wo.z;
        const Vec3 m = ggx_.sampleBounded(wo, u);
        Vec3 wi = reflect(wo, m);
        if (!(wo.z > 0 && wi.z > 0)) return std::nullopt;
        // fcos / pdf with D(m) cancelled: finite at every angle.
        const float bounded = ggx_.boundedReflection(wo);
        const Spectrum weight = reflectance(wo, m) * (0.25f * ggx_.maskingOverCosine(wo, wi) / bounded);
        if (below) wi.z = -wi.z;
        return std::optional<BsdfSample>(std::in_place, wi, weight, bounded * ggx_.D(m), lobes());
    }

  private:
    // Fresnel's reflectance, with the light of further bounces between microfacets added: 1 + F0 (1 - E)/E
    // [Turquin2019]. Exact for F = 1 and equal widths; not reciprocal.
    Spectrum reflectance(Vec3 wo, Vec3 m) const {
        const float albedo = ggxAlbedo(wo.z, std::min(effectiveWidth(wo), 1.f));
        const Spectrum compensation = fma(normalReflectance_, Spectrum(1 / albedo - 1), Spectrum(1.f));
        return fresnelConductor(std::min(dot(wo, m), 1.f), n_, k_) * compensation;
    }

    // The width of an isotropic surface that loses about as much as this one: at grazing angles the width along wo
    // counts, from above both. Our own fit: with anisotropy 0.7 the furnace errs by 1 % for roughness up to 0.3 and by
    // 13 % at 0.6; very rough and very anisotropic surfaces err by up to a half.
    float effectiveWidth(Vec3 wo) const {
        const float x2 = square(ggx_.alphaX()), y2 = square(ggx_.alphaY());
        const float above = std::sqrt(ggx_.alphaX() * ggx_.alphaY() * 0.5f * (x2 + y2));
        return std::sqrt((x2 * wo.x * wo.x + y2 * wo.y * wo.y) / (1 + wo.z) + above * wo.z);
    }

    Spectrum n_, k_, normalReflectance_;
    Ggx ggx_;
};

class Conductor final : public Material {
  public:
    explicit Conductor(const ConductorParams& params)
        : n_(*params.index.n), k_(*params.index.k), ggx_(Ggx::fromRoughness(params.roughness, params.anisotropy)) {}

    const Bsdf* bsdf(const SurfaceHit&, const Wavelengths& wavelengths, Arena& arena) const noexcept override {
        const Spectrum n = n_.at(wavelengths), k = k_.at(wavelengths);
        if (ggx_.smooth()) return arena.make<SmoothConductorBsdf>(n, k);
        return arena.make<RoughConductorBsdf>(n, k, ggx_);
    }

  private:
    const Curve &n_, &k_;
    Ggx ggx_;
};

} // namespace

schema::TypeInfo conductorType() {
    using namespace schema;
    return {.kind = Kind::material,
            .name = "conductor",
            .doc = "Metal, from its measured complex refractive index; smooth or rough, on both sides.",
            .example = "material gold conductor { index metal Au; roughness 0.2 }",
            .fields = {
                field(FieldType::complexIndex, "index", &ConductorParams::index)
                    .doc("Complex refractive index: a metal by name, or n and k as spectra.")
                    .example("index metal Au")
                    .range(0, 1e6)
                    .required()
                    .synonyms({"eta", "ior", "metal", "material"}),
                field(FieldType::number, "roughness", &ConductorParams::roughness)
                    .doc("0 is a mirror, 1 is as rough as it gets; the GGX width α is its square.")
                    .example("roughness 0.2")
                    .unit({Dimension::none, Dimension::fraction})
                    .range(0, 1)
                    .byDefault("0")
                    .synonyms({"alpha", "glossiness", "uroughness", "vroughness", "specular_roughness"})
                    .note("α below 0.0005 (roughness below 0.022) is rendered as a perfect mirror"),
                field(FieldType::number, "anisotropy", &ConductorParams::anisotropy)
                    .doc("Stretches the highlight along the tangent: αy = (1 - anisotropy) αx, mean square kept.")
                    .example("anisotropy 0.7")
                    .unit({Dimension::none, Dimension::fraction})
                    .range(0, 1)
                    .byDefault("0")
                    .synonyms({"anisotropic", "specular_roughness_anisotropy", "aspect"}),
            }};
}

std::unique_ptr<const Material> makeConductor(const ConductorParams& params) {
    ABBE_CHECK(params.index.n && params.index.k);
    return std::make_unique<Conductor>(params);
}

} // namespace abbe
