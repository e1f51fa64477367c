#include "materials/dielectric.h"

#include "materials/direction_pairs.h"
#include "materials/fresnel.h"
#include "materials/ggx.h"
#include "materials/interior_curves.h"
#include "render/surface_input.h"
#include "spectrum/curve.h"

#include <optional>

namespace abbe {
namespace {

class Dielectric final : public Material {
  public:
    explicit Dielectric(const DielectricParams& params)
        : ior_(params.ior ? params.ior : &crown_), roughness_(params.roughness, 0, 1),
          ggx_(Ggx::fromRoughness(static_cast<float>(params.roughness.value), 0)) {
        if (params.attenuationColor) attenuation_.emplace(*params.attenuationColor, params.attenuationDistance);
        inside_ = {.absorption = attenuation_ ? &*attenuation_ : params.absorption, .ior = ior_};
        traits_ = {.usesTextures = roughness_.textured(), .seesOutside = true};
        if (!ior_->isConstant()) traits_.needs |= Effect::dispersion;
        if (inside_.absorption) traits_.needs |= Effect::absorption;
    }

    const Bsdf* bsdf(const SurfaceHit& hit, const Wavelengths& wavelengths, Arena& arena) const noexcept override {
        Spectrum n = ior_->at(wavelengths);
        if (hit.outside) n = n / hit.outside->at(wavelengths);
        const Ggx ggx = roughness_.textured() ? Ggx::fromRoughness(roughness_.at(hit), 0) : ggx_;
        if (RoughDielectricBsdf::representable(n, ggx)) return arena.make<RoughDielectricBsdf>(n, ggx);
        return arena.make<SmoothDielectricBsdf>(n);
    }

  private:
    ConstantCurve crown_{1.5}; // of the default
    const Curve* ior_;
    NumberInput roughness_;
    Ggx ggx_; // unless it is textured
    std::optional<AttenuationCurve> attenuation_;
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

namespace {

constexpr Lobes kBothSides = Lobes(Lobe::reflection) | Lobe::transmission;

Spectrum relativeIndex(Spectrum n, bool outside) { return outside ? n : Spectrum(1.f) / n; }

} // namespace

// ---- polished

Lobes SmoothDielectricBsdf::lobes() const noexcept {
    const Lobes lobes = kBothSides | Lobe::delta;
    return disperses_ ? lobes | Lobe::dispersive : lobes;
}

std::optional<BsdfSample> SmoothDielectricBsdf::sample(Vec3 wo, float uLobe, Vec2, Transport transport) const noexcept {
    const Lobes through = Lobes(Lobe::delta) | Lobe::transmission;
    if (absent_) return BsdfSample{-wo, Spectrum(1.f), 1, through};
    if (wo.z == 0) return std::nullopt;
    const Spectrum eta = relativeIndex(n_, wo.z > 0);
    const Spectrum reflectance = fresnelDielectric(std::abs(wo.z), eta);
    const float probability = mean(reflectance);
    if (uLobe >= probability) return transmit(wo, eta, Spectrum(1.f) - reflectance, 1 - probability, transport);
    return std::optional<BsdfSample>(std::in_place, Vec3{-wo.x, -wo.y, wo.z}, reflectance / probability, probability,
                                     Lobes(Lobe::delta) | Lobe::reflection);
}

std::optional<BsdfSample> SmoothDielectricBsdf::transmit(Vec3 wo, Spectrum eta, Spectrum share, float probability,
                                                         Transport transport) const {
    // Snell's law in double: wi is then right to the last bit of its floats.
    const double ratio = 1 / static_cast<double>(eta[0]), x = -ratio * wo.x, y = -ratio * wo.y;
    const double cos2 = 1 - x * x - y * y;
    // Total reflection of the hero alone: other lanes made transmission possible, the hero has no share in it.
    if (!(cos2 > 0 && probability > 0)) return std::nullopt;
    const double z = std::copysign(std::sqrt(cos2), -wo.z);
    const Vec3 wi{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
    Lobes lobe = Lobes(Lobe::delta) | Lobe::transmission;
    if (disperses_) lobe |= Lobe::dispersive;
    return std::optional<BsdfSample>(std::in_place, wi, share * compression(eta, transport) / probability, probability,
                                     lobe, eta[0]);
}

DeltaEval SmoothDielectricBsdf::evalDelta(Vec3 wo, Vec3 wi) const noexcept {
    if (absent_) return isStraight(wo, wi) ? DeltaEval{Spectrum(1.f), 1} : DeltaEval{};
    if (wo.z == 0) return {};
    const Spectrum eta = relativeIndex(n_, wo.z > 0);
    const Spectrum reflectance = fresnelDielectric(std::abs(wo.z), eta);
    const float probability = mean(reflectance);
    if (isMirrored(wo, wi)) return {reflectance, probability};
    if (!isRefracted(wo, wi, eta[0])) return {};
    return {(Spectrum(1.f) - reflectance) * compression(eta, Transport::radiance), 1 - probability};
}

// ---- rough

Lobes RoughDielectricBsdf::lobes() const noexcept {
    const Lobes lobes = kBothSides | Lobe::glossy;
    return disperses_ ? lobes | Lobe::dispersive : lobes;
}

// By the mean index, which is the same for all rotations of the hero.
ScatterOutline RoughDielectricBsdf::outline(Vec3 wo) const noexcept {
    const Spectrum eta = relativeIndex(n_, wo.z > 0);
    const float reflected = mean(fresnelDielectric(std::min(std::abs(wo.z), 1.f), eta));
    const float alpha2 = square(ggx_.alphaX());
    ScatterOutline result{.diffuse = 0};
    result.add({.share = reflected, .alpha2 = alpha2});
    result.add({.share = 1 - reflected, .alpha2 = alpha2, .eta = mean(eta)});
    return result;
}

// [Turquin2019], but for each part by itself.
RoughDielectricBsdf::Scale RoughDielectricBsdf::lossless(float mu, Spectrum eta) const {
    if (!disperses_) {
        const InterfaceShares<float> shares = ggxInterface(mu, ggx_.alphaX(), eta[0]);
        return {Spectrum(shares.reflection()), Spectrum(shares.transmission())};
    }
    Float8 reflection, transmission;
    for (int i = 0; i < kLanes; ++i) {
        const InterfaceShares<float> shares = ggxInterface(mu, ggx_.alphaX(), eta[i]);
        reflection[i] = shares.reflection(), transmission[i] = shares.transmission();
    }
    return {Spectrum(reflection), Spectrum(transmission)};
}

RoughDielectricBsdf::Facet RoughDielectricBsdf::facet(const Scale& scale, float c, Spectrum eta) {
    const Spectrum r = fresnelDielectric(c, eta);
    Facet f{r * scale.reflection, (Spectrum(1.f) - r) * scale.transmission, 0};
    const float reflected = mean(f.reflected);
    f.probability = reflected / (reflected + mean(f.transmitted));
    return f;
}

BsdfEval RoughDielectricBsdf::eval(Vec3 wo, Vec3 wi, Transport transport) const noexcept {
    const Spectrum eta = relativeIndex(n_, wo.z > 0);
    if (wo.z < 0) wo.z = -wo.z, wi.z = -wi.z;
    if (!(wo.z > 0) || !(wi.z != 0)) return {};
    if (wi.z > 0) return evalReflection(wo, wi, eta);
    const LaneEval lanes = transmission(wo, wi, eta, transport);
    if (!disperses_) return {lanes.fcos, lanes.pdf[0]};
    // The hero alone may be unable to refract this way. Spectral MIS still needs the others' densities, which are
    // stated relative to it: a density far too small to matter stands for its 0.
    const float pdf = std::max(lanes.pdf[0], 1e-7f * maxLane(lanes.pdf));
    if (!(pdf > 0)) return {};
    return {lanes.fcos, pdf, lanes.pdf / pdf};
}

BsdfEval RoughDielectricBsdf::evalReflection(Vec3 wo, Vec3 wi, Spectrum eta) const {
    const Vec3 h = normalize(wo + wi); // both z > 0: never 0
    const Facet at = facet(lossless(wo.z, eta), std::min(dot(wo, h), 1.f), eta);
    const float d = 0.25f * ggx_.D(h);
    return {at.reflected * (d * ggx_.maskingOverCosine(wo, wi)), at.probability * d * ggx_.visible(wo)};
}

// Value and density per lane, each off its own microfacet.
RoughDielectricBsdf::LaneEval RoughDielectricBsdf::transmission(Vec3 wo, Vec3 wi, Spectrum eta,
                                                                Transport transport) const {
    const RefractingHalves halves(wo, wi, eta);
    const Spectrum cosine = max(min(Spectrum(halves.cosO), Spectrum(1.f)), Spectrum(0.f));
    const Scale scale = lossless(wo.z, eta);
    const Spectrum through = (Spectrum(1.f) - fresnelDielectric(cosine, eta)) * scale.transmission;
    Spectrum chosen(1 - facet(scale, cosine[0], eta).probability); // of transmission off each lane's microfacet
    if (disperses_)
        for (int i = 1; i < kLanes; ++i) chosen.v[i] = 1 - facet(scale, cosine[i], eta).probability;

    const Spectrum common = halves.density(ggx_.alphaX(), ggx_.alphaX(), eta);
    const Spectrum fcos = through * common * ggx_.maskingOverCosine(wo, wi) * compression(eta, transport);
    const Spectrum pdf = chosen * common * ggx_.visible(wo), none(0.f);
    return {select(halves.possible, fcos, none), select(halves.possible, pdf, none)};
}

std::optional<BsdfSample> RoughDielectricBsdf::sample(Vec3 wo, float uLobe, Vec2 u,
                                                      Transport transport) const noexcept {
    const Spectrum eta = relativeIndex(n_, wo.z > 0);
    const bool below = wo.z < 0;
    if (below) wo.z = -wo.z;
    if (!(wo.z > 0)) return std::nullopt;
    const Vec3 m = ggx_.sampleVisible(wo, u);
    const float cosO = std::min(dot(wo, m), 1.f);
    if (!(cosO > 0)) return std::nullopt;
    const Facet at = facet(lossless(wo.z, eta), cosO, eta);
    std::optional<BsdfSample> result;
    if (uLobe >= at.probability) {
        result = sampleTransmission(wo, m, eta, at, transport);
    } else if (const Vec3 wi = reflect(wo, m); wi.z > 0) {
        const float visible = ggx_.visible(wo), kept = ggx_.maskingOverCosine(wo, wi) / visible; // G2/G1
        result.emplace(wi, at.reflected * (kept / at.probability), 0.25f * at.probability * ggx_.D(m) * visible,
                       Lobes(Lobe::glossy) | Lobe::reflection);
    }
    if (result && below) result->wi.z = -result->wi.z;
    return result;
}

std::optional<BsdfSample> RoughDielectricBsdf::sampleTransmission(Vec3 wo, Vec3 m, Spectrum eta, const Facet& at,
                                                                  Transport transport) const {
    const float hero = eta[0], cosO = std::min(dot(wo, m), 1.f);
    const float contrast = (hero - 1) * (hero + 1), g2 = contrast + cosO * cosO;
    if (!(g2 > 0)) return std::nullopt; // total reflection of the hero
    const float g = std::sqrt(g2);      // η cos θt
    const Vec3 wi = (m * (cosO - g) - wo) * (1 / hero);
    if (!(wi.z < 0)) return std::nullopt;
    const Lobes lobe = Lobes(Lobe::glossy) | Lobe::transmission;
    if (disperses_) {
        const LaneEval lanes = transmission(wo, wi, eta, transport);
        const float pdf = lanes.pdf[0];
        if (!(pdf > 0)) return std::nullopt;
        return std::optional<BsdfSample>(std::in_place, wi, lanes.fcos / pdf, pdf, lobe | Lobe::dispersive, hero,
                                         lanes.pdf / pdf);
    }
    const float probability = 1 - at.probability, visible = ggx_.visible(wo);
    const float kept = ggx_.maskingOverCosine(wo, wi) / visible; // G2/G1
    // |wo + η wi| = g - cosO, without the cancellation.
    const float length2 = square(contrast / (cosO + g));
    const float pdf = probability * ggx_.D(m) * visible * cosO * hero * g / length2;
    const Spectrum weight = at.transmitted * compression(eta, transport) * (kept / probability);
    return std::optional<BsdfSample>(std::in_place, wi, weight, pdf, lobe, hero);
}

} // namespace abbe
