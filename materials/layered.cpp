#include "materials/layered.h"

#include "materials/bent_normal.h"
#include "materials/direction_pairs.h"
#include "materials/gloss.h"
#include "math/vec.h"

#include <algorithm>
#include <iterator>

namespace abbe {
namespace {

constexpr float kThickest = 100; // of thickness-scale

// What the coat must know of its base.
struct BaseLook {
    Spectrum albedo{0.f};
    float spread = 1; // 0: a mirror, 1: as wide as Lambert's
};

// By a few samples that are the same every time: not an estimate with noise but a part of the model, exact where all
// weights are the same. The spread comes from the length of the mean direction, 1 for a mirror and 2/3 for Lambert.
BaseLook lookAt(const Bsdf& base) {
    constexpr int kSide = 4;
    const Vec3 wo{0.74535599f, 0, 2 / 3.f}; // the mean cosine of diffuse light
    BaseLook look;
    Vec3 sum;
    float count = 0;
    for (int k = 0; k < kSide * kSide; ++k) {
        const Vec2 u{(static_cast<float>(k % kSide) + 0.5f) / kSide, (static_cast<float>(k / kSide) + 0.5f) / kSide};
        const float uLobe = (static_cast<float>(k * 7 % (kSide * kSide)) + 0.5f) / (kSide * kSide);
        const auto s = base.sample(wo, uLobe, u, Transport::radiance);
        if (!s) continue;
        look.albedo += s->weight;
        sum = sum + s->wi;
        ++count;
    }
    look.albedo = min(look.albedo * (1.f / (kSide * kSide)), Spectrum(1.f));
    if (count > 0) look.spread = std::clamp(3 * (1 - length(sum) / count), 0.f, 1.f);
    return look;
}

// Albedo scaling [Kulla2017]: the base gets what the coat does not reflect of the light towards the eye, tinted along
// the refracted way in and out, and darkened by what the coat reflects back onto it [Andersson2024]. Not reciprocal.
class LayeredBsdf final : public Bsdf {
  public:
    LayeredBsdf(const Gloss& gloss, const Bsdf& base, Spectrum depth, float darkening)
        : gloss_(gloss), base_(base), depth_(depth), darkening_(darkening) {
        if (darkening > 0 && !gloss.absent()) look_ = lookAt(base);
    }

    Lobes lobes() const noexcept override {
        if (gloss_.absent()) return base_.lobes();
        return base_.lobes() | Lobe::reflection | (gloss_.smooth() ? Lobe::delta : Lobe::glossy);
    }

    BsdfEval eval(Vec3 wo, Vec3 wi, Transport transport) const noexcept override {
        BsdfEval e = base_.eval(wo, wi, transport);
        if (!(wo.z > 0)) return e; // from behind there is no coat
        const float p = coatShare(wo);
        const float basePdf = e.pdfSolidAngle * (1 - p);
        e.fcos *= passing(wo, wi);
        e.pdfSolidAngle = basePdf;
        if (gloss_.smooth() || gloss_.absent() || !(wi.z > 0)) return e;
        const Gloss::Value coat = gloss_.eval(wo, wi);
        e.fcos += Spectrum(coat.fcos);
        e.pdfSolidAngle += coat.pdf * p;
        if (e.pdfSolidAngle > 0)
            e.pdfRatio = fma(e.pdfRatio, Spectrum(basePdf / e.pdfSolidAngle), Spectrum(coat.pdf * p / e.pdfSolidAngle));
        return e;
    }

    std::optional<BsdfSample> sample(Vec3 wo, float uLobe, Vec2 u, Transport transport) const noexcept override {
        if (!(wo.z > 0)) return base_.sample(wo, uLobe, u, transport);
        const float p = coatShare(wo);
        if (uLobe < p) return sampleCoat(wo, u, p, transport);
        auto s = base_.sample(wo, std::clamp((uLobe - p) / (1 - p), 0.f, kOneMinusEpsilon), u, transport);
        if (!s) return s;
        const Spectrum passes = passing(wo, s->wi);
        const float own = s->pdfSolidAngle * (1 - p);
        const bool coated = !s->lobe.has(Lobe::delta) && !gloss_.smooth() && !gloss_.absent() && s->wi.z > 0;
        const Gloss::Value coat = coated ? gloss_.eval(wo, s->wi) : Gloss::Value{};
        const float pdf = own + coat.pdf * p;
        if (!(pdf > 0)) return std::nullopt;
        s->weight = fma(s->weight * passes, Spectrum(s->pdfSolidAngle / pdf), Spectrum(coat.fcos / pdf));
        s->pdfRatio = fma(s->pdfRatio, Spectrum(own / pdf), Spectrum(coat.pdf * p / pdf));
        s->pdfSolidAngle = pdf;
        return s;
    }

    DeltaEval evalDelta(Vec3 wo, Vec3 wi) const noexcept override {
        DeltaEval result = base_.evalDelta(wo, wi);
        if (!(wo.z > 0)) return result;
        const float p = coatShare(wo);
        result.ratio *= passing(wo, wi);
        result.probability *= 1 - p;
        if (gloss_.smooth() && !gloss_.absent() && isMirrored(wo, wi)) result += {Spectrum(gloss_.albedo(wo.z)), p};
        return result;
    }

    ScatterOutline outline(Vec3 wo) const noexcept override {
        if (!(wo.z > 0)) return base_.outline(wo);
        const float p = coatShare(wo);
        ScatterOutline result{.diffuse = 0};
        result.add(base_.outline(wo), 1 - p);
        if (!gloss_.smooth() && !gloss_.absent()) result.add({.share = p, .alpha2 = square(gloss_.alpha())});
        return result;
    }

  private:
    std::optional<BsdfSample> sampleCoat(Vec3 wo, Vec2 u, float p, Transport transport) const {
        if (gloss_.smooth())
            return std::optional<BsdfSample>(std::in_place, Vec3{-wo.x, -wo.y, wo.z}, Spectrum(gloss_.albedo(wo.z) / p),
                                             p, Lobes(Lobe::delta) | Lobe::reflection);
        const auto wi = gloss_.sample(wo, u);
        if (!wi) return std::nullopt;
        const BsdfEval base = base_.eval(wo, *wi, transport);
        const float own = gloss_.eval(wo, *wi).pdf, basePdf = base.pdfSolidAngle * (1 - p), pdf = own * p + basePdf;
        if (!(own > 1e-36f)) return std::nullopt; // below, its inverse overflows
        const Spectrum weight = fma(base.fcos / pdf, passing(wo, *wi), Spectrum(gloss_.weight(wo, *wi) * (own / pdf)));
        return std::optional<BsdfSample>(std::in_place, *wi, weight, pdf, Lobes(Lobe::glossy) | Lobe::reflection, 1.f,
                                         fma(base.pdfRatio, Spectrum(basePdf / pdf), Spectrum(own * p / pdf)));
    }

    // Probability of the coat; never 1, so that a black base is found, too.
    float coatShare(Vec3 wo) const {
        const float coat = gloss_.albedo(wo.z);
        return coat / (coat + (1 - coat) * std::max(mean(look_.albedo), 0.1f));
    }

    // What the base keeps of its light: (1 - E(ωo)) Δ T.
    Spectrum passing(Vec3 wo, Vec3 wi) const {
        const float eta2 = square(gloss_.ior());
        const auto way = [eta2](float cosine) { return 1 / std::sqrt(1 - (1 - cosine * cosine) / eta2); };
        // A base that lets light through sends it out at the back: one way only.
        const float length = 0.5f * (way(std::abs(wo.z)) + (wi.z > 0 ? way(wi.z) : 0));
        const float through = 1 - gloss_.albedo(wo.z);
        const float matte = 1 - (1 - gloss_.meanAlbedo()) / eta2, shiny = gloss_.albedo(wo.z);
        const float back = (shiny + (matte - shiny) * look_.spread) * darkening_; // K
        const Spectrum darkened = Spectrum(1 - back) / (Spectrum(1.f) - look_.albedo * back);
        return exp(depth_ * -length) * darkened * through;
    }

    Gloss gloss_;
    const Bsdf& base_;
    Spectrum depth_; // optical, for the way in and out
    float darkening_;
    BaseLook look_;
};

class Layered final : public Material {
  public:
    Layered(const LayeredParams& params, const Material& base, KeptTables* kept)
        : base_(base), gloss_(params.ior->at(587.6), params.roughness, kept), tint_(params.tint, 1),
          absorption_(params.absorption), thickness_(static_cast<float>(params.thickness)),
          scale_(params.thicknessScale, 0, kThickest), darkening_(params.darkening, 0, 1) {
        traits_ = {
            .needs = base.needs(),
            .isOpaque = base.isOpaque(),
            .reversible = base.reversible(),
            .focuses = base.reversible(), // by the coat, if not by the base
            .usesTextures = base.usesTextures() || gloss_.textured() || tint_.textured() || scale_.textured() ||
                            darkening_.textured(),
            .mayBeOpen = base.mayBeOpen(),
            .seesOutside = base.seesOutside(),
        };
    }

    const Bsdf* bsdf(const SurfaceHit& hit, const Wavelengths& lambda, Arena& arena) const noexcept override {
        return arena.make<LayeredBsdf>(gloss_.at(hit), partBsdf(base_, hit, lambda, arena), depth(hit, lambda),
                                       darkening_.at(hit));
    }
    float opacity(const SurfaceHit& hit) const noexcept override { return base_.opacity(hit); }

  private:
    Spectrum depth(const SurfaceHit& hit, const Wavelengths& lambda) const {
        if (absorption_) return absorption_->at(lambda) * (2 * thickness_ * scale_.at(hit));
        if (tint_.absent()) return Spectrum(0.f);
        return log(max(tint_.at(hit, lambda), Spectrum(1e-6f))) * -scale_.at(hit); // black counts as 1e-6
    }

    const Material& base_;
    GlossRange gloss_;
    SpectrumInput tint_;
    const Curve* absorption_;
    float thickness_;
    NumberInput scale_, darkening_;
};

// What the coat absorbs, and how thick it is.
std::vector<schema::FieldInfo> absorptionFields() {
    using namespace schema;
    using P = LayeredParams;
    return {
        field(FieldType::spectrum, "tint", &P::tint)
            .role(SpectrumRole::albedo)
            .range(0, 1)
            .group("absorption")
            .synonyms({"coat_color", "color"})
            .doc("Share of the light left after going straight in and out again; all when absent.")
            .example("tint rgb 0.9 0.7 0.4"),
        field(FieldType::spectrum, "absorption", &P::absorption)
            .role(SpectrumRole::unbounded)
            .unit({Dimension::inverseLength, Dimension::none})
            .range(0, 1e12)
            .group("absorption")
            .synonyms({"sigma_a"})
            .doc("Absorption coefficient of the coat, 1/m, instead of tint.")
            .example("absorption rgb 0.5 2 6 per-mm"),
        field(FieldType::quantity, "thickness", &P::thickness)
            .unit({Dimension::length})
            .range(0, 1)
            .byDefault("0.1 mm")
            .synonyms({"depth"})
            .doc("Thickness of the coat, for its absorption.")
            .example("thickness 50 um"),
        field(FieldType::number, "thickness-scale", &P::thicknessScale)
            .unit({Dimension::none, Dimension::fraction})
            .range(0, static_cast<double>(kThickest))
            .byDefault("1")
            .synonyms({"coat_thickness"})
            .doc("Factor on the thickness, for absorption or tint: a texture lets lacquer pool and wear off.")
            .example("thickness-scale ramp { input noise { scale 5 cm }; stop 0.4 0.2; stop 0.6 1 }"),
    };
}

} // namespace

schema::TypeInfo layeredType() {
    using namespace schema;
    using P = LayeredParams;
    std::vector<FieldInfo> fields = {
        field(FieldType::reference, "base", &P::base)
            .to(Kind::material)
            .required()
            .synonyms({"substrate", "bottom", "under"})
            .doc("Name of the material under the coat, or one written in place.")
            .example("base diffuse { reflectance 0.3 }"),
        field(FieldType::spectrum, "ior", &P::ior)
            .role(SpectrumRole::index)
            .range(1, 4)
            .byDefault("1.5")
            .synonyms({"coat_ior", "coat_IOR", "eta"})
            .doc("Refractive index of the coat, that at 587.6 nm for all wavelengths; 1 is no coat.")
            .example("ior 1.5"),
        field(FieldType::number, "roughness", &P::roughness)
            .unit({Dimension::none, Dimension::fraction})
            .range(0, 1)
            .byDefault("0")
            .synonyms({"coat_roughness", "alpha"})
            .doc("Roughness of the coat: 0 polished, 1 matte.")
            .example("roughness 0.1"),
    };
    std::ranges::move(absorptionFields(), std::back_inserter(fields));
    fields.push_back(
        field(FieldType::number, "darkening", &P::darkening)
            .unit({Dimension::none, Dimension::fraction})
            .range(0, 1)
            .byDefault("1")
            .synonyms({"coat_darkening"})
            .doc("How much the light reflected back onto the base darkens it: 1 as in nature, 0 not at all.")
            .example("darkening 50 %"));
    return {.kind = Kind::material,
            .name = "layered",
            .doc = "A clear coat over another material: varnish, lacquer, a wet film.",
            .example = "material wood layered { base diffuse { reflectance rgb 0.4 0.2 0.1 }; roughness 0.1 }",
            .fields = std::move(fields)};
}

std::unique_ptr<const Material> makeLayered(const LayeredParams& params, const Material& base, KeptTables* kept) {
    return std::make_unique<Layered>(params, base, kept);
}

} // namespace abbe
