#include "materials/mix.h"

#include "materials/bent_normal.h"
#include "math/vec.h"
#include "render/surface_input.h"

#include <algorithm>

namespace abbe {
namespace {

bool sameCurve(const Curve* a, const Curve* b) {
    if (a == b) return true;
    if (!a || !b) return false;
    for (double nm = 360; nm <= 830; nm += 5)
        if (std::abs(a->at(nm) - b->at(nm)) > 1e-6 * std::abs(a->at(nm))) return false;
    return true;
}

class Mix final : public Material {
  public:
    Mix(const MixParams& params, const Material& first, const Material& second)
        : first_(first), second_(second), amount_(params.amount, 0, 1) {
        inside_ = (hasInside(second) ? second : first).inside();
        traits_ = {
            .needs = first.needs() | second.needs(),
            .reversible = first.reversible() && second.reversible(),
            .focuses = first.focuses() || second.focuses(),
            .usesTextures = amount_.textured() || first.usesTextures() || second.usesTextures(),
            .mayBeOpen = first.mayBeOpen() || second.mayBeOpen(),
            .seesOutside = first.seesOutside() || second.seesOutside(),
        };
    }

    const Bsdf* bsdf(const SurfaceHit& hit, const Wavelengths& lambda, Arena& arena) const noexcept override {
        const Shares s = shares(hit);
        // Of what hits the surface at all.
        const float sum = s.first + s.second, amount = sum > 0 ? s.second / sum : 0;
        if (!(amount > 0)) return &partBsdf(first_, hit, lambda, arena);
        if (!(amount < 1)) return &partBsdf(second_, hit, lambda, arena);
        return arena.make<MixedBsdf>(partBsdf(first_, hit, lambda, arena), partBsdf(second_, hit, lambda, arena),
                                     amount);
    }
    float opacity(const SurfaceHit& hit) const noexcept override {
        const Shares s = shares(hit);
        return s.first + s.second;
    }

  private:
    struct Shares {
        float first, second;
    };
    Shares shares(const SurfaceHit& hit) const {
        const float amount = amount_.at(hit);
        if (!mayBeOpen()) return {1 - amount, amount};
        return {(1 - amount) * first_.opacity(hit), amount * second_.opacity(hit)};
    }

    const Material &first_, &second_;
    NumberInput amount_;
};

} // namespace

bool hasInside(const Material& m) { return m.interior() || m.absorption() || m.ior(); }

bool sameInside(const Material& a, const Material& b) {
    return a.interior() == b.interior() && sameCurve(a.absorption(), b.absorption()) && sameCurve(a.ior(), b.ior()) &&
           a.priority() == b.priority();
}

schema::TypeInfo mixMaterialType() {
    using namespace schema;
    return {.kind = Kind::material,
            .name = "mix",
            .doc = "Two materials side by side, too fine to see apart: rust on steel, dust on glass.",
            .example = "material bronze mix { first conductor { index metal Cu }; second diffuse; amount 30 % }",
            .fields = {
                field(FieldType::reference, "first", &MixParams::first)
                    .to(Kind::material)
                    .required()
                    .synonyms({"a", "base", "material", "material1"})
                    .doc("Name of a material, or one written in place; all of it where `amount` is 0.")
                    .example("first conductor { index metal Fe; roughness 0.3 }"),
                field(FieldType::reference, "second", &MixParams::second)
                    .to(Kind::material)
                    .required()
                    .synonyms({"b", "material2"})
                    .doc("The other material; all of it where `amount` is 1.")
                    .example("second diffuse { reflectance 0.1 }"),
                field(FieldType::number, "amount", &MixParams::amount)
                    .unit({Dimension::none, Dimension::fraction})
                    .range(0, 1)
                    .byDefault("0.5")
                    .synonyms({"mask", "weight", "blend", "factor", "mix"})
                    .doc("Share of the second material, 0 … 1.")
                    .example("amount 30 %"),
            }};
}

std::unique_ptr<const Material> makeMix(const MixParams& params, const Material& first, const Material& second) {
    return std::make_unique<Mix>(params, first, second);
}

namespace {

// The sum of two shares; densities of lanes other than the hero's are stated relative to the hero's.
BsdfEval sum(const BsdfEval& a, float shareA, const BsdfEval& b, float shareB) {
    const float pdfA = a.pdfSolidAngle * shareA, pdfB = b.pdfSolidAngle * shareB, pdf = pdfA + pdfB;
    if (!(pdf > 0)) return {};
    BsdfEval result;
    result.fcos = fma(a.fcos, Spectrum(shareA), b.fcos * shareB);
    result.pdfSolidAngle = pdf;
    result.pdfRatio = fma(a.pdfRatio, Spectrum(pdfA / pdf), b.pdfRatio * (pdfB / pdf));
    return result;
}

} // namespace

BsdfEval MixedBsdf::eval(Vec3 wo, Vec3 wi, Transport transport) const noexcept {
    return sum(parts_[0]->eval(wo, wi, transport), shares_[0], parts_[1]->eval(wo, wi, transport), shares_[1]);
}

std::optional<BsdfSample> MixedBsdf::sample(Vec3 wo, float uLobe, Vec2 u, Transport transport) const noexcept {
    // What is left of the number is uniform again; rounding must not make it 1 (docs/hard_cases.md, case 37).
    const bool second = uLobe >= shares_[0];
    const float share = shares_[second], rest = second ? uLobe - shares_[0] : uLobe;
    auto s = parts_[second]->sample(wo, std::clamp(rest / share, 0.f, kOneMinusEpsilon), u, transport);
    if (!s) return s;
    if (s->lobe.has(Lobe::delta)) {
        s->pdfSolidAngle *= share;
        return s;
    }
    const BsdfEval other = parts_[!second]->eval(wo, s->wi, transport);
    const float own = s->pdfSolidAngle * share, theirs = other.pdfSolidAngle * shares_[!second], pdf = own + theirs;
    if (!(own > 1e-36f)) return std::nullopt; // below, its inverse overflows
    s->weight = fma(s->weight, Spectrum(own / pdf), other.fcos * shares_[!second] / pdf);
    s->pdfRatio = fma(s->pdfRatio, Spectrum(own / pdf), other.pdfRatio * (theirs / pdf));
    s->pdfSolidAngle = pdf;
    return s;
}

DeltaEval MixedBsdf::evalDelta(Vec3 wo, Vec3 wi) const noexcept {
    DeltaEval result;
    for (int i = 0; i < 2; ++i) {
        const DeltaEval part = parts_[i]->evalDelta(wo, wi);
        result += {part.ratio * shares_[i], part.probability * shares_[i]};
    }
    return result;
}

ScatterOutline MixedBsdf::outline(Vec3 wo) const noexcept {
    ScatterOutline result{.diffuse = 0};
    for (int i = 0; i < 2; ++i) result.add(parts_[i]->outline(wo), shares_[i]);
    return result;
}

} // namespace abbe
