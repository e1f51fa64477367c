#include "materials/diffuse_transmission.h"

#include "base/diagnostic.h"
#include "math/warp.h"
#include "render/surface_input.h"

#include <fmt/format.h>

namespace abbe {
namespace {

constexpr float kDefault = 0.25f;

class DiffuseTransmissionBsdf final : public Bsdf {
  public:
    DiffuseTransmissionBsdf(Spectrum reflectance, Spectrum transmittance)
        : reflectance_(reflectance), transmittance_(transmittance) {
        const float r = mean(reflectance), t = mean(transmittance);
        chance_ = r + t > 0 ? r / (r + t) : 1;
    }

    Lobes lobes() const noexcept override { return Lobes(Lobe::diffuse) | Lobe::reflection | Lobe::transmission; }

    BsdfEval eval(Vec3 wo, Vec3 wi, Transport) const noexcept override {
        if (wo.z == 0 || wi.z == 0) return {};
        const bool reflected = (wo.z > 0) == (wi.z > 0);
        const float lambert = cosineHemispherePdf(std::abs(wi.z));
        return {(reflected ? reflectance_ : transmittance_) * lambert, (reflected ? chance_ : 1 - chance_) * lambert};
    }

    std::optional<BsdfSample> sample(Vec3 wo, float uLobe, Vec2 u, Transport) const noexcept override {
        const bool reflected = uLobe < chance_;
        const float chance = reflected ? chance_ : 1 - chance_;
        Vec3 wi = squareToCosineHemisphere(u);
        const float pdf = chance * cosineHemispherePdf(wi.z);
        if (pdf == 0 || wo.z == 0) return std::nullopt;
        wi.z = std::copysign(wi.z, reflected ? wo.z : -wo.z);
        return std::optional<BsdfSample>(std::in_place, wi, (reflected ? reflectance_ : transmittance_) / chance, pdf,
                                         Lobes(Lobe::diffuse) | (reflected ? Lobe::reflection : Lobe::transmission));
    }

  private:
    Spectrum reflectance_, transmittance_;
    float chance_; // of a reflection
};

class DiffuseTransmission final : public Material {
  public:
    explicit DiffuseTransmission(const DiffuseTransmissionParams& p)
        : reflectance_(p.reflectance, kDefault), transmittance_(p.transmittance, kDefault) {
        traits_ = {.focuses = false, .usesTextures = reflectance_.textured() || transmittance_.textured()};
    }

    const Bsdf* bsdf(const SurfaceHit& hit, const Wavelengths& lambda, Arena& arena) const noexcept override {
        const Spectrum r = reflectance_.at(hit, lambda), t = transmittance_.at(hit, lambda);
        // Two textures know nothing of each other: where they exceed 1 together both are scaled.
        const Spectrum scale = Spectrum(1.f) / max(r + t, Spectrum(1.f));
        return arena.make<DiffuseTransmissionBsdf>(r * scale, t * scale);
    }

  private:
    SpectrumInput reflectance_, transmittance_;
};

} // namespace

bool checkParams(const DiffuseTransmissionParams& p, const schema::PlaceOf& placeOf, Diagnostics& diagnostics) {
    if (p.reflectance.texture || p.transmittance.texture) return true;
    const auto value = [](const Curve* curve, double nm) { return curve ? curve->at(nm) : kDefault; };
    double most = 0, where = 0;
    for (double nm = 360; nm <= 830; ++nm) {
        const double both = value(p.reflectance.curve, nm) + value(p.transmittance.curve, nm);
        if (both > most) most = both, where = nm;
    }
    if (most <= 1 + 1e-5) return true; // curves are held in single precision
    diagnostics
        .error("E0710", placeOf(p.transmittance.curve ? "transmittance" : "reflectance"),
               "reflectance and transmittance together exceed 1", fmt::format("{:.3f} at {} nm", most, where))
        .help =
        p.reflectance.curve && p.transmittance.curve
            ? "scale one of them: what is reflected is not transmitted"
            : fmt::format("`{}` is {} when left out", p.reflectance.curve ? "transmittance" : "reflectance", kDefault);
    return false;
}

schema::TypeInfo diffuseTransmissionType() {
    using namespace schema;
    return {.kind = Kind::material,
            .name = "diffuse-transmission",
            .doc = "Leaf, paper, lampshade: a thin matte sheet that also lets light through, in all directions.",
            .example =
                "material leaf diffuse-transmission { reflectance rgb 0.1 0.3 0.05; transmittance rgb 0.1 0.4 0.05 }",
            .fields = {
                field(FieldType::spectrum, "reflectance", &DiffuseTransmissionParams::reflectance)
                    .doc("Share that leaves on the side of the light, on both sides.")
                    .example("reflectance rgb 0.1 0.3 0.05")
                    .role(SpectrumRole::albedo)
                    .range(0, 1)
                    .byDefault("0.25")
                    .synonyms({"Kd", "Kr", "albedo", "color", "diffuse_reflectance"})
                    .note("with transmittance at most 1 at every wavelength; textures are scaled where they are more"),
                field(FieldType::spectrum, "transmittance", &DiffuseTransmissionParams::transmittance)
                    .doc("Share that leaves on the other side.")
                    .example("transmittance rgb 0.1 0.4 0.05")
                    .role(SpectrumRole::albedo)
                    .range(0, 1)
                    .byDefault("0.25")
                    .synonyms({"Kt", "diffuse_transmittance", "translucency", "subsurface_color"}),
            }};
}

std::unique_ptr<const Material> makeDiffuseTransmission(const DiffuseTransmissionParams& params) {
    return std::make_unique<DiffuseTransmission>(params);
}

} // namespace abbe
