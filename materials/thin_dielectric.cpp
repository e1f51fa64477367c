#include "materials/thin_dielectric.h"

#include "materials/direction_pairs.h"
#include "materials/fresnel.h"
#include "render/surface_input.h"

namespace abbe {
namespace {

// All that the two faces reflect to and fro between them, without interference [Born1999, §7.6, averaged over phase]:
// with R of one face and τ of one pass R' = R + (1 - R)² τ² R / (1 - τ² R²), T' = (1 - R)² τ / (1 - τ² R²). Light goes
// straight on: the second face undoes the refraction of the first.
class ThinDielectricBsdf final : public Bsdf {
  public:
    ThinDielectricBsdf(Spectrum ior, Spectrum tint) : ior_(ior), tint_(tint) {}

    Lobes lobes() const noexcept override { return kReflection | kTransmission; }
    BsdfEval eval(Vec3, Vec3, Transport) const noexcept override { return {}; }

    std::optional<BsdfSample> sample(Vec3 wo, float uLobe, Vec2, Transport) const noexcept override {
        if (wo.z == 0) return std::nullopt;
        const Shares s = shares(std::abs(wo.z));
        const float r = mean(s.reflected), t = mean(s.transmitted);
        if (!(r + t > 0)) return std::nullopt;
        const float mirrored = r / (r + t), straight = t / (r + t);
        if (uLobe < mirrored)
            return std::optional<BsdfSample>(std::in_place, Vec3{-wo.x, -wo.y, wo.z}, s.reflected / mirrored, mirrored,
                                             kReflection);
        if (!(straight > 0)) return std::nullopt; // all of it mirrored, up to rounding
        return std::optional<BsdfSample>(std::in_place, -wo, s.transmitted / straight, straight, kTransmission);
    }
    DeltaEval evalDelta(Vec3 wo, Vec3 wi) const noexcept override {
        const bool mirrored = isMirrored(wo, wi);
        if (!mirrored && !isStraight(wo, wi)) return {};
        const Shares s = shares(std::abs(wo.z));
        const float r = mean(s.reflected), t = mean(s.transmitted);
        if (!(r + t > 0)) return {};
        return mirrored ? DeltaEval{s.reflected, r / (r + t)} : DeltaEval{s.transmitted, t / (r + t)};
    }

  private:
    static constexpr Lobes kReflection = Lobes(Lobe::delta) | Lobe::reflection;
    static constexpr Lobes kTransmission = Lobes(Lobe::delta) | Lobe::transmission;

    struct Shares {
        Spectrum reflected, transmitted;
    };

    Shares shares(float cosine) const {
        const Spectrum one(1.f), face = fresnelDielectric(cosine, ior_);
        // Slanted light has a longer way inside: 1/cos θ' of the thickness, by Snell's law.
        const Spectrum sine2 = Spectrum((1 - cosine) * (1 + cosine)) / (ior_ * ior_);
        const Spectrum inside = sqrt(max(one - sine2, Spectrum(1e-8f)));
        const Spectrum pass = exp(log(max(tint_, Spectrum(kBlack))) / inside);
        const Spectrum faces = pass * face;
        // As a product, which keeps the digits that (1 - R)² has near grazing; 0 only where a face reflects everything
        // and nothing comes in.
        const Spectrum round = max((one - faces) * (one + faces), Spectrum(1e-20f));
        const Spectrum through = (one - face) * (one - face);
        return {min(face + through * pass * faces / round, one), min(through * pass / round, one)};
    }

    static constexpr float kBlack = 1e-12f; // its logarithm is finite
    Spectrum ior_, tint_;
};

class ThinDielectric final : public Material {
  public:
    explicit ThinDielectric(const ThinDielectricParams& p) : ior_(p.ior), tint_(p.tint, 1) {
        traits_ = {.usesTextures = tint_.textured()};
    }

    const Bsdf* bsdf(const SurfaceHit& hit, const Wavelengths& lambda, Arena& arena) const noexcept override {
        return arena.make<ThinDielectricBsdf>(ior_ ? ior_->at(lambda) : Spectrum(1.5f), tint_.at(hit, lambda));
    }

  private:
    const Curve* ior_; // null: 1.5
    SpectrumInput tint_;
};

} // namespace

schema::TypeInfo thinDielectricType() {
    using namespace schema;
    return {.kind = Kind::material,
            .name = "thin-dielectric",
            .doc = "A clear sheet whose two faces are one surface: reflects between them, lets light straight through.",
            .example = "material pane thin-dielectric { ior glass BK7; tint 0.98 }",
            .fields = {
                field(FieldType::spectrum, "ior", &ThinDielectricParams::ior)
                    .doc("Refractive index of the sheet.")
                    .example("ior glass BK7")
                    .role(SpectrumRole::index)
                    .range(1, 10)
                    .byDefault("1.5")
                    .synonyms({"eta", "int_ior", "index", "n"}),
                field(FieldType::spectrum, "tint", &ThinDielectricParams::tint)
                    .doc("Share of the light inside that one pass at a right angle leaves.")
                    .example("tint rgb 0.6 0.8 0.7")
                    .role(SpectrumRole::albedo)
                    .range(0, 1)
                    .byDefault("1")
                    .synonyms({"color", "transmittance", "specular_transmittance", "Kt"}),
            }};
}

std::unique_ptr<const Material> makeThinDielectric(const ThinDielectricParams& params) {
    return std::make_unique<ThinDielectric>(params);
}

} // namespace abbe
