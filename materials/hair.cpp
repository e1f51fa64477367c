#include "materials/hair.h"

#include "materials/hair_bsdf.h"
#include "render/surface_input.h"

#include <cmath>

namespace abbe {
namespace {

Spectrum power(const Wavelengths& lambda, float atGreen, float exponent) {
    return exp(log(Spectrum(550.f) / lambda.nm) * exponent) * atGreen;
}

// Of many fibres that show this colour together, a fit to simulated hair [Chiang2016, eq. 9].
Spectrum absorptionOfColor(Spectrum color, float bn) {
    const float scale = 5.969f + bn * (-0.215f + bn * (2.532f + bn * (-10.73f + bn * (5.574f + bn * 0.245f))));
    const Spectrum root = log(max(color, Spectrum(1e-4f))) / scale; // darker is the same black
    return root * root;
}

class Hair final : public Material {
  public:
    explicit Hair(const HairParams& p)
        : eumelanin_(p.eumelanin, 0, kMostMelanin), pheomelanin_(p.pheomelanin, 0, kMostMelanin),
          absorption_(p.absorption), color_(p.color, 1), longitudinal_(p.longitudinalRoughness, 0, 1),
          azimuthal_(p.azimuthalRoughness, 0, 1) {
        fibre_.eta = static_cast<float>(p.ior);
        fibre_.sinScale = static_cast<float>(std::sin(p.scaleAngle));
        fibre_.cosScale = static_cast<float>(std::cos(p.scaleAngle));
    }

    const Bsdf* bsdf(const SurfaceHit& hit, const Wavelengths& lambda, Arena& arena) const noexcept override {
        HairBsdf::Fibre fibre = fibre_;
        fibre.h = 1 - 2 * hit.uv.y; // curves: v runs along x × wo
        const float bn = azimuthal_.at(hit);
        fibre.variance = hairVariance(longitudinal_.at(hit));
        fibre.width = hairAzimuthalWidth(bn);
        if (absorption_) fibre.absorption = absorption_->at(lambda);
        if (!color_.absent()) fibre.absorption = absorptionOfColor(color_.at(hit, lambda), bn);
        if (const float c = eumelanin_.at(hit); c > 0) fibre.absorption += eumelaninAbsorption(lambda) * c;
        if (const float c = pheomelanin_.at(hit); c > 0) fibre.absorption += pheomelaninAbsorption(lambda) * c;
        return arena.make<HairBsdf>(fibre);
    }
    bool usesTextures() const override {
        return eumelanin_.textured() || pheomelanin_.textured() || color_.textured() || longitudinal_.textured() ||
               azimuthal_.textured();
    }

    // All that happens in a fibre has happened where light met it from outside: on its way out of a tube it goes on.
    Effects needs() const override { return Effect::interfaces; }
    bool reversible() const override { return false; }
    bool mayBeOpen() const override { return true; }
    float opacity(const SurfaceHit& hit) const noexcept override { return dot(hit.arrival, hit.ng) > 0 ? 0.f : 1.f; }

    static constexpr float kMostMelanin = 100;

  private:
    NumberInput eumelanin_, pheomelanin_;
    const Curve* absorption_; // null: none
    SpectrumInput color_;
    NumberInput longitudinal_, azimuthal_;
    HairBsdf::Fibre fibre_; // what is the same everywhere
};

} // namespace

Spectrum eumelaninAbsorption(const Wavelengths& lambda) { return power(lambda, 0.697f, 3.33f); }
Spectrum pheomelaninAbsorption(const Wavelengths& lambda) { return power(lambda, 0.4f, 4.75f); }

namespace {

using namespace schema;

std::vector<FieldInfo> pigmentFields() {
    return {
        field(FieldType::number, "eumelanin", &HairParams::eumelanin)
            .doc("Concentration of black and brown pigment: 0.3 blond, 1.3 brown, 8 black; none: white hair.")
            .example("eumelanin 1.3")
            .range(0, Hair::kMostMelanin)
            .byDefault("0")
            .synonyms({"melanin", "melanin_concentration"}),
        field(FieldType::number, "pheomelanin", &HairParams::pheomelanin)
            .doc("Concentration of red pigment.")
            .example("pheomelanin 0.8")
            .range(0, Hair::kMostMelanin)
            .byDefault("0")
            .synonyms({"melanin_redness"}),
        field(FieldType::spectrum, "absorption", &HairParams::absorption)
            .doc("Absorption by a dye, besides pigment: coefficient times the radius of the fibre.")
            .example("absorption table { - 400 0.2; - 700 3 }")
            .role(SpectrumRole::unbounded)
            .range(0, 1e6)
            .group("dye")
            .synonyms({"sigma_a", "absorption_coefficient"}),
        field(FieldType::spectrum, "color", &HairParams::color)
            .doc("Dye, as the colour of a head of hair, instead of absorption; below 0.0001 it is that.")
            .example("color rgb 0.5 0.1 0.3")
            .role(SpectrumRole::albedo)
            .range(0, 1)
            .group("dye")
            .synonyms({"reflectance", "base_color", "tint"}),
    };
}

std::vector<FieldInfo> shapeFields() {
    return {
        field(FieldType::number, "ior", &HairParams::ior)
            .doc("Refractive index of the fibre.")
            .example("ior 1.55")
            .range(1.05, 3)
            .byDefault("1.55")
            .synonyms({"eta", "index"}),
        field(FieldType::number, "longitudinal-roughness", &HairParams::longitudinalRoughness)
            .doc("Width of the highlights along the fibre (βm).")
            .example("longitudinal-roughness 0.2")
            .unit({Dimension::none, Dimension::fraction})
            .range(0, 1)
            .byDefault("0.3")
            .synonyms({"beta_m", "roughness"})
            .note("below 0.0135 it is that"),
        field(FieldType::number, "azimuthal-roughness", &HairParams::azimuthalRoughness)
            .doc("Width of the highlights around the fibre (βn).")
            .example("azimuthal-roughness 0.4")
            .unit({Dimension::none, Dimension::fraction})
            .range(0, 1)
            .byDefault("0.3")
            .synonyms({"beta_n", "radial_roughness"})
            .note("below 0.006 it is that"),
        field(FieldType::quantity, "scale-angle", &HairParams::scaleAngle)
            .doc("By how much the scales stand off; curves run from root to tip.")
            .example("scale-angle 3 deg")
            .unit({Dimension::angle})
            .range(-0.5, 0.5)
            .byDefault("2 deg")
            .synonyms({"alpha", "offset"}),
    };
}

} // namespace

schema::TypeInfo hairType() {
    std::vector<FieldInfo> fields = pigmentFields();
    for (FieldInfo& f : shapeFields()) fields.push_back(std::move(f));
    return {.kind = Kind::material,
            .name = "hair",
            .doc = "Hair and fur, for curves: a fibre that reflects, lets light through and reflects it inside.",
            .example = "material brown hair { eumelanin 1.3; pheomelanin 0.2 }",
            .fields = std::move(fields)};
}

std::unique_ptr<const Material> makeHair(const HairParams& params) { return std::make_unique<Hair>(params); }

} // namespace abbe
