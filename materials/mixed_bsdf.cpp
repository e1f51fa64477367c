#include "materials/mixed_bsdf.h"

#include "math/vec.h"

#include <algorithm>

namespace abbe {
namespace {

// The sum of two shares; densities of lanes other than the hero's are told relative to the hero's.
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
