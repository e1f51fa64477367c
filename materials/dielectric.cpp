#include "materials/dielectric.h"

#include "materials/attenuation_curve.h"
#include "materials/dielectric_bsdf.h"
#include "render/surface_input.h"
#include "spectrum/curve.h"

namespace abbe {
namespace {

class Dielectric final : public Material {
  public:
    explicit Dielectric(const DielectricParams& params)
        : ior_(params.ior ? params.ior : &crown_), roughness_(params.roughness, 0, 1),
          ggx_(Ggx::fromRoughness(static_cast<float>(params.roughness.value), 0)), absorption_(params.absorption) {
        if (!params.attenuationColor) return;
        attenuation_ = std::make_unique<AttenuationCurve>(*params.attenuationColor, params.attenuationDistance);
        absorption_ = attenuation_.get();
    }

    Effects needs() const override {
        Effects effects;
        if (!ior_->isConstant()) effects |= Effect::dispersion;
        if (absorption_) effects |= Effect::absorption;
        return effects;
    }

    const Bsdf* bsdf(const SurfaceHit& hit, const Wavelengths& wavelengths, Arena& arena) const noexcept override {
        Spectrum n = ior_->at(wavelengths);
        if (hit.outside) n = n / hit.outside->at(wavelengths);
        const Ggx ggx = roughness_.textured() ? Ggx::fromRoughness(roughness_.at(hit), 0) : ggx_;
        if (RoughDielectricBsdf::representable(n, ggx)) return arena.make<RoughDielectricBsdf>(n, ggx);
        return arena.make<SmoothDielectricBsdf>(n);
    }

    const Curve* absorption() const override { return absorption_; }
    const Curve* ior() const override { return ior_; }
    bool usesTextures() const override { return roughness_.textured(); }

  private:
    ConstantCurve crown_{1.5}; // of the default
    const Curve* ior_;
    NumberInput roughness_;
    Ggx ggx_;                 // unless it is textured
    const Curve* absorption_; // null: clear
    std::unique_ptr<const Curve> attenuation_;
};

} // namespace

schema::TypeInfo dielectricType() {
    using namespace schema;
    return {.kind = Kind::material,
            .name = "dielectric",
            .doc =
                "Transparent solid or liquid: reflects and refracts; an index that varies with wavelength disperses.",
            .example = "material flint dielectric { ior glass SF11 }",
            .fields = {
                field(FieldType::spectrum, "ior", &DielectricParams::ior)
                    .doc("Refractive index of the inside; outside it is 1.")
                    .example("ior glass BK7")
                    .role(SpectrumRole::index)
                    .range(0.2, 10)
                    .byDefault("1.5")
                    .synonyms({"eta", "int_ior", "index", "specular_ior", "n"}),
                field(FieldType::number, "roughness", &DielectricParams::roughness)
                    .doc("0 is polished, 1 is as rough as it gets; the GGX width α is its square.")
                    .example("roughness 0.3")
                    .unit({Dimension::none, Dimension::fraction})
                    .range(0, 1)
                    .byDefault("0")
                    .synonyms({"alpha", "glossiness", "uroughness", "vroughness", "specular_roughness"})
                    .note("α below 0.0005 (roughness below 0.022) is rendered as polished"),
                field(FieldType::spectrum, "absorption", &DielectricParams::absorption)
                    .doc("Absorption coefficient of the inside, 1/m: exp(-absorption · distance) is left.")
                    .example("absorption table { - 400 12; - 700 1.5 }")
                    .role(SpectrumRole::unbounded)
                    .unit({Dimension::inverseLength, Dimension::none})
                    .range(0, 1e12)
                    .group("absorption")
                    .synonyms({"sigma_a", "extinction", "density"}),
                field(FieldType::spectrum, "attenuation-color", &DielectricParams::attenuationColor)
                    .doc("Share of the light left after attenuation-distance, instead of absorption; 0 counts as 1e-6.")
                    .example("attenuation-color rgb 0.2 0.7 0.5")
                    .role(SpectrumRole::albedo)
                    .range(0, 1)
                    .group("absorption")
                    .synonyms({"attenuationColor", "transmission_color", "absorption_color", "tint"}),
                field(FieldType::quantity, "attenuation-distance", &DielectricParams::attenuationDistance)
                    .doc("Distance inside after which attenuation-color is left.")
                    .example("attenuation-distance 5 cm")
                    .unit({Dimension::length})
                    .range(1e-9, 1e9)
                    .byDefault("1 m")
                    .synonyms({"attenuationDistance", "attenuation-depth", "transmission_depth", "at_distance"}),
            }};
}

std::unique_ptr<const Material> makeDielectric(const DielectricParams& params) {
    return std::make_unique<Dielectric>(params);
}

} // namespace abbe
