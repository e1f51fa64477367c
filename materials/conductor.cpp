#include "materials/conductor.h"

#include "base/check.h"
#include "materials/direction_pairs.h"
#include "materials/fresnel.h"
#include "materials/ggx.h"
#include "materials/stretched_ggx.h"
#include "render/surface_input.h"

namespace abbe {
namespace {

class SmoothConductorBsdf final : public Bsdf {
  public:
    SmoothConductorBsdf(Spectrum n, Spectrum k, Spectrum tint) : n_(n), k_(k), tint_(tint) {}

    Lobes lobes() const noexcept override { return Lobes(Lobe::delta) | Lobe::reflection; }
    BsdfEval eval(Vec3, Vec3, Transport) const noexcept override { return {}; }
    std::optional<BsdfSample> sample(Vec3 wo, float, Vec2, Transport) const noexcept override {
        if (wo.z == 0) return std::nullopt;
        return std::optional<BsdfSample>(std::in_place, Vec3{-wo.x, -wo.y, wo.z},
                                         fresnelConductor(std::abs(wo.z), n_, k_) * tint_, 1.f, lobes());
    }
    DeltaEval evalDelta(Vec3 wo, Vec3 wi) const noexcept override {
        if (!isMirrored(wo, wi)) return {};
        return {fresnelConductor(std::abs(wo.z), n_, k_) * tint_, 1};
    }

  private:
    Spectrum n_, k_, tint_;
};

// Two-sided: directions below the surface are mirrored to +z first.
class RoughConductorBsdf final : public Bsdf {
  public:
    RoughConductorBsdf(Spectrum n, Spectrum k, Spectrum tint, Ggx ggx, const StretchedAlbedo* stretched)
        : n_(n), k_(k), tint_(tint), normalReflectance_(fresnelConductor(1, n, k) * tint), ggx_(ggx),
          stretched_(stretched) {}

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

    ScatterOutline outline(Vec3) const noexcept override {
        ScatterOutline result{.diffuse = 0};
        result.add({.share = 1, .alpha2 = ggx_.alphaX() * ggx_.alphaX()});
        return result;
    }

  private:
    // Fresnel's reflectance, with the light of further bounces between microfacets added: 1 + F0 (1 - E)/E
    // [Turquin2019]. Exact for F = 1; not reciprocal.
    Spectrum reflectance(Vec3 wo, Vec3 m) const {
        const float albedo = stretched_ ? (*stretched_)(wo) : ggxAlbedo(wo.z, widthTowards(wo));
        const Spectrum compensation = fma(normalReflectance_, Spectrum(1 / albedo - 1), Spectrum(1.f));
        return fresnelConductor(std::min(dot(wo, m), 1.f), n_, k_) * compensation * tint_;
    }

    // The width of the profile cut along wo. Where widths come from textures there is no table of what a stretched
    // surface keeps: a round one of this width stands in.
    float widthTowards(Vec3 wo) const {
        if (ggx_.alphaX() == ggx_.alphaY()) return ggx_.alphaX();
        const float s2 = wo.x * wo.x + wo.y * wo.y;
        if (!(s2 > 1e-12f)) return std::sqrt(0.5f * (square(ggx_.alphaX()) + square(ggx_.alphaY())));
        return std::sqrt((square(ggx_.alphaX() * wo.x) + square(ggx_.alphaY() * wo.y)) / s2);
    }

    Spectrum n_, k_, tint_, normalReflectance_;
    Ggx ggx_;
    const StretchedAlbedo* stretched_; // null: both widths are the same, or vary over the surface
};

class Conductor final : public Material {
  public:
    explicit Conductor(const ConductorParams& params)
        : n_(*params.index.n), k_(*params.index.k), roughness_(params.roughness, 0, 1),
          anisotropy_(params.anisotropy, 0, 1), tint_(params.tint, 1),
          shaped_(roughness_.textured() || anisotropy_.textured()) {
        traits_ = {.isOpaque = true, .usesTextures = shaped_ || tint_.textured(), .seesOutside = true};
        if (shaped_) return;
        ggx_ =
            Ggx::fromRoughness(static_cast<float>(params.roughness.value), static_cast<float>(params.anisotropy.value));
        if (!ggx_.smooth() && ggx_.alphaX() != ggx_.alphaY()) stretched_.emplace(ggx_.alphaX(), ggx_.alphaY());
    }

    const Bsdf* bsdf(const SurfaceHit& hit, const Wavelengths& wavelengths, Arena& arena) const noexcept override {
        const Spectrum outside = hit.outside ? hit.outside->at(wavelengths) : Spectrum(1.f);
        const Spectrum n = n_.at(wavelengths) / outside, k = k_.at(wavelengths) / outside;
        const Spectrum tint = tint_.at(hit, wavelengths);
        const Ggx ggx = shaped_ ? Ggx::fromRoughness(roughness_.at(hit), anisotropy_.at(hit)) : ggx_;
        if (ggx.smooth()) return arena.make<SmoothConductorBsdf>(n, k, tint);
        return arena.make<RoughConductorBsdf>(n, k, tint, ggx, stretched_ ? &*stretched_ : nullptr);
    }

  private:
    const Curve &n_, &k_;
    NumberInput roughness_, anisotropy_;
    SpectrumInput tint_;
    bool shaped_; // by textures; else by what follows
    Ggx ggx_{0, 0};
    std::optional<StretchedAlbedo> stretched_;
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
                field(FieldType::spectrum, "tint", &ConductorParams::tint)
                    .doc("Share of the reflected light that remains: a lacquer, tarnish, fingerprints; 1 when absent.")
                    .example("tint 0.8")
                    .role(SpectrumRole::albedo)
                    .range(0, 1)
                    .synonyms({"reflectance", "color", "specular_color", "specular_reflectance"}),
            }};
}

std::unique_ptr<const Material> makeConductor(const ConductorParams& params) {
    ABBE_CHECK(params.index.n && params.index.k);
    return std::make_unique<Conductor>(params);
}

} // namespace abbe
