#include "materials/openpbr_bsdf.h"

#include "materials/dielectric.h"
#include "materials/direction_pairs.h"
#include "math/warp.h"

namespace abbe {
namespace {

bool isOne(const Spectrum& a) { return maxLane(abs(a - kOne)) == 0; }

Vec3 flipped(Vec3 w) { return {w.x, w.y, -w.z}; }

} // namespace

OpenPbrBsdf::OpenPbrBsdf(const OpenPbrPoint& point) : point_(point) {
    const Spectrum& eta = point.dielectric.eta();
    const float weakest = -maxLane(-abs(eta - kOne));
    const Ggx& ggx = point.specular.ggx();
    // A refracted lobe narrower than directions can tell is none, as in materials/dielectric.h.
    smooth_ = ggx.smooth() || (refracts() && std::max(ggx.alphaX(), ggx.alphaY()) * weakest < 5e-5f);
    if (smooth_) point_.specular = GgxLobe(Ggx::fromRoughness(0, 0));
    disperses_ = abbe::disperses(eta);
    coatAbsorbs_ = anyNonZero(point.coatLog);
    sheetAbsorbs_ = !isOne(point.through);
    if (!(point.cover.coat > 0)) return;
    baseAlbedo_ = opaqueAlbedo();
    const float glossy = mean(point.dielectric.reflectance(kOne));
    baseRoughness_ = std::lerp(std::lerp(1.f, point.roughness, glossy), point.roughness, point.metalness);
}

Lobes OpenPbrBsdf::lobes() const noexcept {
    Lobes result = Lobe::reflection;
    const bool coat = point_.cover.coat > 0, opaque = point_.metalness < 1 && point_.transmission < 1;
    const bool sheet = point_.thinWalled && point_.transmission > 0 && point_.metalness < 1;
    if (smooth_ || (coat && point_.coat.smooth()) || (sheet && point_.sheet.smooth())) result |= Lobe::delta;
    if (!smooth_ || (coat && !point_.coat.smooth()) || (sheet && !point_.sheet.smooth())) result |= Lobe::glossy;
    if (opaque || point_.filled || point_.fuzz > 0) result |= Lobe::diffuse;
    if (refracts() || sheet || point_.filled || (opaque && point_.subsurface > 0)) result |= Lobe::transmission;
    if (refracts() && disperses_) result |= Lobe::dispersive;
    return result;
}

OpenPbrBsdf::Passing OpenPbrBsdf::passing(const View& v, float cosI, bool entering) const {
    if (point_.cover.coat == 0) return {Spectrum(v.ground), Spectrum(v.ground)};
    const Spectrum bare(v.ground * (1 - point_.cover.coat));
    Spectrum through = v.covered;
    if (coatAbsorbs_) {
        Spectrum path = v.pathOut;
        if (entering && !v.within) path += point_.coatLog / point_.cover.cosineInCoat(Spectrum(cosI));
        through *= exp(path);
    }
    return {fma(through, v.darkening, bare), bare + through};
}

OpenPbrBsdf::Facet OpenPbrBsdf::facet(const View& v, Spectrum c) const {
    Facet f{kNone, kNone, kNone};
    const float dielectric = 1 - point_.metalness;
    if (point_.metalness > 0) f.opaque = v.metalScale * point_.metal.reflectance(c) * point_.metalness;
    if (v.within) {
        const Spectrum r = point_.dielectric.reflectanceWithin(c);
        f.clear = v.scale * r * v.clear;
        f.transmitted = v.through * (kOne - r) * v.clear;
    } else if (dielectric > 0) {
        const Spectrum r = point_.dielectric.reflectance(c);
        f.opaque += v.scale * point_.tint * r * (dielectric * (1 - point_.transmission));
        if (v.clear > 0) {
            f.clear = v.scale * point_.tint * (point_.thinWalled ? sheetFacet(c).reflected : r) * v.clear;
            if (!point_.thinWalled) f.transmitted = v.through * (kOne - r) * v.clear;
        }
    }
    return f;
}

float OpenPbrBsdf::reflectionShare(const Facet& f) const {
    if (!refracts()) return 1;
    const float reflected = mean(f.opaque + f.clear), through = mean(f.transmitted);
    return reflected + through > 0 ? reflected / (reflected + through) : 1;
}

BsdfEval OpenPbrBsdf::eval(Vec3 wo, Vec3 wi, Transport transport) const noexcept {
    if (!(wo.z != 0 && wi.z != 0)) return {};
    if (point_.filled && wo.z < 0) return leaving(wi);
    return evalFrom(view(wo), wo.z < 0 ? flipped(wi) : wi, transport);
}

BsdfEval OpenPbrBsdf::evalFrom(const View& v, Vec3 wi, Transport transport) const {
    LaneEval lanes = wi.z > 0            ? reflection(v, wi)
                     : point_.thinWalled ? sheetTransmission(v, flipped(wi))
                     : point_.filled     ? entering(v, flipped(wi))
                                         : refraction(v, wi, transport);
    if (!(wi.z < 0 && disperses_ && refracts())) return {lanes.fcos, lanes.pdf[0]};
    // The hero alone may be unable to refract this way; see materials/dielectric.cpp.
    const float pdf = std::max(lanes.pdf[0], 1e-7f * maxLane(lanes.pdf));
    if (!(pdf > 0)) return {};
    return {lanes.fcos, pdf, lanes.pdf / pdf};
}

// wi in the coat's axes.
OpenPbrBsdf::LaneEval OpenPbrBsdf::coatReflection(const View& v, Vec3 wi) const {
    if (!(wi.z > 0)) return {kNone, kNone};
    const Ggx& ggx = point_.coat.ggx();
    const Vec3 h = normalize(v.coatWo + wi);
    const float d = ggx.D(h), share = v.ground * point_.cover.coat * 0.25f * d * ggx.maskingOverCosine(v.coatWo, wi);
    return {v.coatScale * point_.cover.coatReflectance(Spectrum(std::min(dot(v.coatWo, h), 1.f))) * share,
            Spectrum(v.pick[kCoat] * ggx.boundedReflection(v.coatWo) * d)};
}

OpenPbrBsdf::LaneEval OpenPbrBsdf::reflection(const View& v, Vec3 wi) const {
    Spectrum f(0.f);
    float pdf = 0;
    if (v.pick[kFuzz] > 0) {
        const SheenLobe::Value fuzz = point_.sheen.eval(v.wo, wi);
        f += point_.fuzzColor * (point_.fuzz * fuzz.fcos);
        pdf += v.pick[kFuzz] * fuzz.pdf;
    }
    if (v.pick[kCoat] > 0 && !point_.coat.smooth()) {
        const LaneEval coat = coatReflection(v, inCoat(v, wi));
        f += coat.fcos;
        pdf += coat.pdf[0];
    }
    const Vec3 h = normalize(v.wo + wi); // both z > 0: never 0
    const Spectrum c(std::min(dot(v.wo, h), 1.f));
    const Passing pass = passing(v, inCoat(v, wi).z, true);
    if (v.pick[kSpecular] > 0 && !smooth_) {
        const Ggx& ggx = point_.specular.ggx();
        const float d = ggx.D(h);
        const Facet at = facet(v, c);
        f += (at.opaque * pass.opaque + at.clear * pass.clear) * (0.25f * d * ggx.maskingOverCosine(v.wo, wi));
        const float density =
            refracts() ? 0.25f * ggx.visible(v.wo) * reflectionShare(at) : ggx.boundedReflection(v.wo);
        pdf += v.pick[kSpecular] * density * d;
    }
    if (v.pick[kDiffuse] > 0) {
        const float plastic = (1 - point_.metalness) * (1 - point_.transmission), s = point_.subsurface;
        Spectrum matte(0.f);
        if (s < 1) matte = EonDiffuse(point_.base, point_.diffuseRoughness)(v.wo, wi) * (1 - s);
        const float back = s * (1 - point_.forward);
        if (back > 0) matte += EonDiffuse(point_.under, point_.diffuseRoughness)(v.wo, wi) * back;
        f += pass.opaque * v.below * matte * (plastic * wi.z);
        pdf += v.pick[kDiffuse] * cosineHemispherePdf(wi.z);
    }
    return {f, Spectrum(pdf)};
}

// Through a thin-walled surface; wi is turned to the side of wo.
OpenPbrBsdf::LaneEval OpenPbrBsdf::sheetTransmission(const View& v, Vec3 wi) const {
    Spectrum f(0.f);
    float pdf = 0;
    const Passing pass = passing(v, 1, false);
    if (v.pick[kSheet] > 0 && !point_.sheet.smooth()) {
        const Ggx& ggx = point_.sheet.ggx();
        const float d = ggx.D(normalize(v.wo + wi));
        f += pass.clear * v.sheet *
             (v.clear * 0.25f * d * ggx.maskingOverCosine(v.wo, wi) / point_.sheet.mirrorAlbedo(v.wo));
        pdf += v.pick[kSheet] * ggx.boundedReflection(v.wo) * d;
    }
    if (v.pick[kDiffuseThrough] > 0) {
        const float share = (1 - point_.metalness) * (1 - point_.transmission) * point_.subsurface * point_.forward;
        f += pass.opaque * v.below * EonDiffuse(point_.under, point_.diffuseRoughness)(v.wo, wi) * (share * wi.z);
        pdf += v.pick[kDiffuseThrough] * cosineHemispherePdf(wi.z);
    }
    return {f, Spectrum(pdf)};
}

// Into the medium of the subsurface part, whose walk gives it its colour; wi is turned to the side of wo.
OpenPbrBsdf::LaneEval OpenPbrBsdf::entering(const View& v, Vec3 wi) const {
    const float density = cosineHemispherePdf(wi.z);
    const float share = (1 - point_.metalness) * (1 - point_.transmission) * point_.subsurface;
    return {passing(v, 1, false).opaque * v.below * (share * density), Spectrum(v.pick[kDiffuseThrough] * density)};
}

// Out of that medium. Light enters evenly under the gloss and leaves evenly and whole, so that none is lost
// [Kulla2017]; of the layers it meets what the coat absorbs.
BsdfEval OpenPbrBsdf::leaving(Vec3 wi) const {
    if (!(wi.z > 0)) return {};
    const float density = cosineHemispherePdf(wi.z);
    return {(coatAbsorbs_ ? leavingCoat(wi.z) : kOne) * density, density};
}

// Value and density per lane, each off its own microfacet [Walter2007]; see RoughDielectricBsdf::transmission.
OpenPbrBsdf::LaneEval OpenPbrBsdf::refraction(const View& v, Vec3 wi, Transport transport) const {
    if (!refracts() || smooth_ || !(v.pick[kSpecular] > 0)) return {kNone, kNone};
    const Ggx& ggx = point_.specular.ggx();
    const Vec3 wo = v.wo;
    const Spectrum eta = v.within ? kOne / point_.dielectric.eta() : point_.dielectric.eta();
    const RefractingHalves halves(wo, wi, eta);
    const Spectrum cosine = max(min(Spectrum(halves.cosO), kOne), kNone);
    const Facet at = facet(v, cosine);
    Spectrum chosen(1 - reflectionShare(at));
    if (disperses_) // each lane hits another microfacet, whose choice is a mean over all lanes
        for (int i = 0; i < kLanes; ++i) chosen.v[i] = 1 - reflectionShare(facet(v, Spectrum(cosine[i])));
    const Spectrum common = halves.density(ggx.alphaX(), ggx.alphaY(), eta);
    const Passing pass = passing(v, 1, false);
    Spectrum out = pass.clear;
    if (v.within && coatAbsorbs_) out = leavingCoat(-wi.z);
    const Spectrum fcos =
        at.transmitted * point_.through * out * compression(eta, transport) * common * ggx.maskingOverCosine(wo, wi);
    const Spectrum pdf = chosen * common * (v.pick[kSpecular] * ggx.visible(wo));
    return {select(halves.possible, fcos, kNone), select(halves.possible, pdf, kNone)};
}

Spectrum OpenPbrBsdf::leavingCoat(float cosI) const {
    const float coat = point_.cover.coat;
    return mix(kOne, exp(point_.coatLog / point_.cover.cosineInCoat(Spectrum(cosI))), coat);
}

std::optional<BsdfSample> OpenPbrBsdf::sample(Vec3 wo, float uLobe, Vec2 u, Transport transport) const noexcept {
    if (wo.z == 0) return std::nullopt;
    if (point_.filled && wo.z < 0) {
        const Vec3 wi = squareToCosineHemisphere(u);
        const float density = cosineHemispherePdf(wi.z);
        if (!(density > 0)) return std::nullopt;
        return std::optional<BsdfSample>(std::in_place, wi, coatAbsorbs_ ? leavingCoat(wi.z) : kOne, density,
                                         Lobes(Lobe::diffuse) | Lobe::transmission);
    }
    const View& v = view(wo);
    int choice = -1;
    float rest = uLobe;
    for (int i = 0; i < kChoices; ++i) {
        if (!(v.pick[i] > 0)) continue;
        choice = i;
        if (rest < v.pick[i]) break;
        rest -= v.pick[i];
    }
    if (choice < 0) return std::nullopt; // black
    rest = std::min(rest / v.pick[choice], kOneMinusEpsilon);
    const auto chosen = static_cast<Choice>(choice);
    const bool delta = (chosen == kCoat && point_.coat.smooth()) || (chosen == kSpecular && smooth_) ||
                       (chosen == kSheet && point_.sheet.smooth());
    std::optional<BsdfSample> result;
    if (delta) {
        result = sampleSmooth(v, chosen, rest, transport);
    } else if (const auto wi = direction(v, chosen, rest, u)) {
        const BsdfEval e = evalFrom(v, *wi, transport);
        if (!(e.pdfSolidAngle > 1e-36f)) return std::nullopt; // below, its inverse overflows
        const bool through = wi->z < 0, refracted = through && refracts();
        Lobes lobe = Lobes(chosen >= kDiffuse || chosen == kFuzz ? Lobe::diffuse : Lobe::glossy) |
                     (through ? Lobe::transmission : Lobe::reflection);
        if (refracted && disperses_) lobe |= Lobe::dispersive;
        const float hero = point_.dielectric.eta()[0];
        result.emplace(*wi, e.fcos / e.pdfSolidAngle, e.pdfSolidAngle, lobe,
                       refracted ? (v.within ? 1 / hero : hero) : 1, e.pdfRatio);
    }
    if (result && wo.z < 0) result->wi.z = -result->wi.z;
    return result;
}

std::optional<Vec3> OpenPbrBsdf::direction(const View& v, Choice choice, float rest, Vec2 u) const {
    Vec3 wi;
    switch (choice) {
    case kFuzz:
        wi = point_.sheen.sample(v.wo, u);
        break;
    case kCoat:
        wi = reflect(v.coatWo, point_.coat.ggx().sampleBounded(v.coatWo, u));
        if (!(wi.z > 0)) return std::nullopt;
        wi = outOfCoat(v, wi);
        break;
    case kSpecular: {
        const Ggx& ggx = point_.specular.ggx();
        if (!refracts()) {
            wi = reflect(v.wo, ggx.sampleBounded(v.wo, u));
            break;
        }
        const Vec3 m = ggx.sampleVisible(v.wo, u);
        const float c = std::min(dot(v.wo, m), 1.f);
        if (!(c > 0)) return std::nullopt;
        if (rest >= reflectionShare(facet(v, Spectrum(c)))) return refracted(v, m, c);
        wi = reflect(v.wo, m);
        break;
    }
    case kSheet:
        wi = reflect(v.wo, point_.sheet.ggx().sampleBounded(v.wo, u));
        break;
    default:
        wi = squareToCosineHemisphere(u);
    }
    if (!(wi.z > 0)) return std::nullopt;
    return choice == kSheet || choice == kDiffuseThrough ? flipped(wi) : wi;
}

// The hero's direction through the microfacet m, hit at cosine c.
std::optional<Vec3> OpenPbrBsdf::refracted(const View& v, Vec3 m, float c) const {
    const float n = point_.dielectric.eta()[0], eta = v.within ? 1 / n : n;
    const float g2 = (eta - 1) * (eta + 1) + c * c;
    if (!(g2 > 0)) return std::nullopt; // total reflection of the hero
    const Vec3 wi = (m * (c - std::sqrt(g2)) - v.wo) * (1 / eta);
    return wi.z < 0 ? std::optional(wi) : std::nullopt;
}

DeltaEval OpenPbrBsdf::coatMirror(const View& v) const {
    const Spectrum reflected = v.coatScale * point_.cover.coatReflectance(Spectrum(v.coatWo.z));
    return {reflected * (v.ground * point_.cover.coat), v.pick[kCoat]};
}

DeltaEval OpenPbrBsdf::sheetPassage(const View& v) const {
    return {passing(v, 1, false).clear * v.sheet * v.clear, v.pick[kSheet]};
}

DeltaEval OpenPbrBsdf::baseMirror(const View& v, const Facet& at) const {
    const Passing pass = passing(v, inCoat(v, {-v.wo.x, -v.wo.y, v.wo.z}).z, true);
    return {at.opaque * pass.opaque + at.clear * pass.clear, v.pick[kSpecular] * reflectionShare(at)};
}

DeltaEval OpenPbrBsdf::basePassage(const View& v, const Facet& at, float cosI, Transport transport) const {
    const Spectrum eta = v.within ? kOne / point_.dielectric.eta() : point_.dielectric.eta();
    const Spectrum out = v.within && coatAbsorbs_ ? leavingCoat(cosI) : passing(v, 1, false).clear;
    return {at.transmitted * point_.through * out * compression(eta, transport),
            v.pick[kSpecular] * (1 - reflectionShare(at))};
}

DeltaEval OpenPbrBsdf::evalDelta(Vec3 wo, Vec3 wi) const noexcept {
    if (!(wo.z != 0 && wi.z != 0) || (point_.filled && wo.z < 0)) return {};
    const View& v = view(wo);
    if (wo.z < 0) wi = flipped(wi);
    DeltaEval result;
    if (v.pick[kCoat] > 0 && point_.coat.smooth()) {
        const Vec3 mirror = outOfCoat(v, {-v.coatWo.x, -v.coatWo.y, v.coatWo.z});
        if (wi.z > 0 && mirror.z > 0 && nearlyEqual({wi.x, wi.y}, {mirror.x, mirror.y})) result += coatMirror(v);
    }
    if (v.pick[kSheet] > 0 && point_.sheet.smooth() && isStraight(v.wo, wi)) result += sheetPassage(v);
    if (!(v.pick[kSpecular] > 0) || !smooth_) return result;
    const float n = point_.dielectric.eta()[0];
    const Facet at = facet(v, Spectrum(v.wo.z));
    if (isMirrored(v.wo, wi)) result += baseMirror(v, at);
    if (refracts() && isRefracted(v.wo, wi, v.within ? 1 / n : n))
        result += basePassage(v, at, -wi.z, Transport::radiance);
    return result;
}

std::optional<BsdfSample> OpenPbrBsdf::sampleSmooth(const View& v, Choice choice, float rest,
                                                    Transport transport) const {
    const Lobes through = Lobes(Lobe::delta) | Lobe::transmission, back = Lobes(Lobe::delta) | Lobe::reflection;
    const auto sampled = [](Vec3 wi, const DeltaEval& e, Lobes lobe, float eta = 1) {
        return std::optional<BsdfSample>(std::in_place, wi, e.ratio / e.probability, e.probability, lobe, eta);
    };
    if (choice == kCoat) {
        const Vec3 wi = outOfCoat(v, {-v.coatWo.x, -v.coatWo.y, v.coatWo.z});
        return wi.z > 0 ? sampled(wi, coatMirror(v), back) : std::nullopt;
    }
    if (choice == kSheet) return sampled(-v.wo, sheetPassage(v), through);
    const Facet at = facet(v, Spectrum(v.wo.z));
    const float share = reflectionShare(at);
    if (rest < share) return sampled({-v.wo.x, -v.wo.y, v.wo.z}, baseMirror(v, at), back);
    // Snell's law in double: wi is then right to the last bit of its floats.
    const Spectrum eta = v.within ? kOne / point_.dielectric.eta() : point_.dielectric.eta();
    const double ratio = 1 / static_cast<double>(eta[0]), x = -ratio * v.wo.x, y = -ratio * v.wo.y;
    const double cos2 = 1 - x * x - y * y;
    if (!(cos2 > 0 && share < 1)) return std::nullopt; // total reflection of the hero alone
    const Vec3 wi{static_cast<float>(x), static_cast<float>(y), static_cast<float>(-std::sqrt(cos2))};
    return sampled(wi, basePassage(v, at, -wi.z, transport), disperses_ ? through | Lobe::dispersive : through, eta[0]);
}

} // namespace abbe
