// What of an OpenPBR surface depends on the direction of view alone: the albedos by which its layers share the light.
#include "materials/dielectric.h"
#include "materials/openpbr_bsdf.h"

#include <cmath>

namespace abbe {

double hemisphericalReflectance(double n) {
    if (std::abs(n - 1) < 1e-3) return 0;
    if (n < 1) return 1 - n * n * (1 - hemisphericalReflectance(1 / n)); // by reciprocity, total reflection included
    const double n2 = n * n, n4 = n2 * n2, minus = n2 - 1, plus = n2 + 1;
    return 0.5 + (n - 1) * (3 * n + 1) / (6 * (n + 1) * (n + 1)) +
           n2 * minus * minus / (plus * plus * plus) * std::log((n - 1) / (n + 1)) -
           2 * n * n2 * (n2 + 2 * n - 1) / (plus * (n4 - 1)) +
           8 * n4 * (n4 + 1) / (plus * (n4 - 1) * (n4 - 1)) * std::log(n);
}

const OpenPbrBsdf::View& OpenPbrBsdf::view(Vec3 wo) const {
    if (!(wo == viewed_)) {
        view_ = makeView(wo);
        viewed_ = wo;
    }
    return view_;
}

OpenPbrBsdf::View OpenPbrBsdf::makeView(Vec3 wo) const {
    View v;
    v.within = wo.z < 0 && refracts();
    v.wo = {wo.x, wo.y, std::abs(wo.z)};
    v.coatWo = v.wo;
    if (point_.coatFrame) turnCoat(v, wo.z < 0);
    v.opaque = point_.metalness + (1 - point_.metalness) * (1 - point_.transmission);
    v.clear = (1 - point_.metalness) * point_.transmission;
    v.coatScale = v.pathOut = v.sheet = Spectrum(0.f);
    v.darkening = kOne;
    const float fuzz = v.within || point_.fuzz == 0 ? 0 : point_.fuzz * point_.sheen.albedo(v.wo.z);
    v.ground = 1 - fuzz;
    v.covered = Spectrum(v.ground * point_.cover.coat);
    if (v.within)
        viewWithin(v);
    else
        viewDielectric(v);
    // Light that further bounces between the microfacets return, as in materials/conductor.cpp.
    v.metalScale = kOne;
    if (point_.metalness > 0)
        v.metalScale = fma(point_.metal.reflectance(kOne), Spectrum(1 / point_.specular.mirrorAlbedo(v.wo) - 1), kOne);
    for (float& p : v.pick) p = 0;
    v.pick[kFuzz] = fuzz * mean(point_.fuzzColor);
    if (!v.within && point_.cover.coat > 0) viewCoat(v);
    choose(v);
    return v;
}

// Single scattering is scaled so that what it reflects and what goes through sum to 1.
void OpenPbrBsdf::viewDielectric(View& v) const {
    const OpenPbrDielectric& d = point_.dielectric;
    v.scale = v.through = kOne;
    v.below = Spectrum(0.f);
    if (point_.metalness == 1) return;
    const auto reflectance = [&](Spectrum c) { return d.reflectance(c); };
    const auto bare = [&](Spectrum c) { return fresnelDielectric(c, d.eta()); };
    const GgxLobe& lobe = point_.specular;
    const float mirror = lobe.mirrorAlbedo(v.wo);
    const Spectrum mean = lobeMean(lobe, v.wo, d.eta(), d.kinks(false), reflectance, d.varies(), 1);
    if (!point_.thinWalled) {
        setInterface(v, d.eta(), reflectance, bare);
        // Plastic keeps its light whatever the scale of its gloss: the matte part gets the rest.
        if (!refracts()) v.scale = min(v.scale, Spectrum(1 / mirror));
        v.below = max(kOne - v.scale * mean * mirror, Spectrum(0.f));
        return;
    }
    v.scale = Spectrum(1 / mirror); // the sheet's other lobe is scaled to fit
    v.below = kOne - mean;
    if (point_.transmission > 0)
        v.sheet = lobeMean(
            lobe, v.wo, d.eta(), d.kinks(false), [&](Spectrum c) { return sheetFacet(c).through; },
            d.varies() || sheetAbsorbs_, 0);
}

void OpenPbrBsdf::viewWithin(View& v) const {
    const OpenPbrDielectric& d = point_.dielectric;
    const Spectrum eta = kOne / d.eta();
    setInterface(
        v, eta, [&](Spectrum c) { return d.reflectanceWithin(c); },
        [&](Spectrum c) { return fresnelDielectric(c, eta); });
    v.below = kOne;
}

// Mean of f over the light that a perfect mirror of the lobe's shape would reflect; `beyond`: its value where an
// interface of that index reflects totally.
template <typename F>
Spectrum OpenPbrBsdf::lobeMean(const GgxLobe& lobe, Vec3 wo, Spectrum eta, const MetCosines::Kinks& kinks, F&& f,
                               bool varies, float beyond) const {
    const OpenPbrDielectric& d = point_.dielectric;
    const Spectrum cosines = lobe.cosines(wo);
    const float critical = criticalCosine(eta);
    if (lobe.smooth() || !(std::max(critical, std::ranges::max(kinks)) > 0)) return d.meanOver(cosines, f, varies);
    const auto more = [&](Spectrum c) { return f(c) - Spectrum(beyond); };
    const MetCosines points(cosines, lobe.spread(wo), critical, kinks, true);
    const Spectrum change = points.integral(more, MicrofacetEscape(lobe.ggx(), wo, eta), varies, disperses_).reflected;
    return min(max(Spectrum(beyond) + change / lobe.mirrorAlbedo(wo), Spectrum(0.f)), kOne);
}

// What single scattering at the interface returns and transmits, with the weights of InterfaceShares: what it would if
// it reflected everything, changed wherever it transmits by what leaves the microfacets on either side. Where tables
// know that of the bare interface, only the change that film and coat make is left to integrate.
template <typename Covered, typename Bare>
void OpenPbrBsdf::setInterface(View& v, Spectrum eta, Covered&& covered, Bare&& bare) const {
    const GgxLobe& lobe = point_.specular;
    const OpenPbrDielectric& d = point_.dielectric;
    InterfaceShares<Spectrum> shares = lobe.interface(v.wo, eta, disperses_, v.within);
    const bool tabulated = lobe.tabulated(eta, disperses_, v.within);
    if (refracts() && !lobe.smooth() && (!tabulated || d.covered())) {
        const auto more = [&](Spectrum c) { return covered(c) - (tabulated ? bare(c) : kOne); };
        const float critical = d.critical(v.within);
        const MetCosines points(lobe.cosines(v.wo), lobe.spread(v.wo), critical, d.kinks(v.within),
                                critical > 0 || !tabulated);
        const auto change = points.integral(more, MicrofacetEscape(lobe.ggx(), v.wo, eta), d.varies(), disperses_);
        if (!tabulated) shares.kept = shares.turned * (2 * lobe.mirrorAlbedo(v.wo));
        shares.kept += (shares.turned * change.reflected - (kOne - shares.turned) * change.refracted) * 2;
        shares.kept = max(shares.kept, Spectrum(1e-3f));
    }
    v.scale = shares.reflection();
    v.through = shares.transmission();
}

// Seen from the back of a sheet, what leans to the right there leans to the right here: of directions stated as if both
// sides were the front, the normal changes its slope. Where the coat turns its back on wo, it is seen edge-on.
void OpenPbrBsdf::turnCoat(View& v, bool back) const {
    constexpr float edge = 1e-3f;
    const Frame& f = *point_.coatFrame;
    v.coatFrame = back ? Frame{{f.x.x, f.x.y, -f.x.z}, {f.y.x, f.y.y, -f.y.z}, {-f.z.x, -f.z.y, f.z.z}} : f;
    v.coatWo = v.coatFrame.toLocal(v.wo);
    if (v.coatWo.z < edge) v.coatWo = normalize(Vec3{v.coatWo.x, v.coatWo.y, edge});
}

// The coat reflects, absorbs and darkens: what returns from an opaque base hits the coat's surface from below and is
// partly sent back, (1 - K)/(1 - E K) of it gets out in the end.
void OpenPbrBsdf::viewCoat(View& v) const {
    const OpenPbrCover& cover = point_.cover;
    const GgxLobe& lobe = point_.coat;
    const auto reflectance = [&](Spectrum c) { return cover.coatReflectance(c); };
    const bool varies = disperses(cover.coatEta);
    const float mirror = lobe.mirrorAlbedo(v.coatWo);
    v.coatScale = min(lobe.interface(v.coatWo, cover.coatEta, varies, false).reflection(), Spectrum(1 / mirror));
    const Spectrum albedo = v.coatScale * lobeMean(lobe, v.coatWo, cover.coatEta, {}, reflectance, varies, 1) * mirror;
    v.pick[kCoat] = v.ground * cover.coat * abbe::mean(albedo);
    v.covered *= kOne - albedo;
    if (coatAbsorbs_) v.pathOut = point_.coatLog / cover.cosineInCoat(Spectrum(v.coatWo.z));
    if (!(point_.coatDarkening > 0 && v.opaque > 0)) return;
    const Spectrum smooth = cover.coatReflectance(Spectrum(v.coatWo.z));
    const Spectrum sentBack = mix(smooth, Spectrum(point_.coatReturns), baseRoughness_);
    const Spectrum dark = (kOne - sentBack) / max(kOne - baseAlbedo_ * sentBack, Spectrum(1e-6f));
    v.darkening = mix(kOne, dark, point_.coatDarkening);
}

// Albedo of the opaque base at normal incidence.
Spectrum OpenPbrBsdf::opaqueAlbedo() const {
    const float plastic = (1 - point_.metalness) * (1 - point_.transmission), whole = point_.metalness + plastic;
    if (!(whole > 0)) return kOne;
    const Spectrum f = point_.dielectric.reflectance(kOne);
    const Spectrum diffuse = mix(point_.base, point_.under, point_.subsurface);
    const Spectrum dielectric = f * point_.tint + (kOne - f) * diffuse;
    return (point_.metal.reflectance(kOne) * point_.metalness + dielectric * plastic) / whole;
}

// Probabilities of the lobes, in proportion to the mean of their albedos over the lanes: the same for all rotations of
// the hero.
void OpenPbrBsdf::choose(View& v) const {
    const Passing pass = passing(v, v.coatWo.z, true);
    const float plastic = (1 - point_.metalness) * (1 - point_.transmission);
    const Spectrum mirror = kOne - v.below, metal = point_.metal.reflectance(Spectrum(v.wo.z)) * point_.metalness;
    Spectrum specular = pass.opaque * (metal + (v.within ? Spectrum(0.f) : mirror * point_.tint * plastic));
    if (v.clear > 0) {
        if (point_.thinWalled) {
            specular += pass.clear * v.clear * mirror;
            v.pick[kSheet] = mean(pass.clear * v.clear * v.sheet);
        } else {
            specular += pass.clear * v.clear * (v.within ? kOne : mirror + v.below);
        }
    }
    v.pick[kSpecular] = mean(specular);
    const Spectrum matte = pass.opaque * v.below * plastic;
    const float back = point_.subsurface * (1 - point_.forward), through = point_.subsurface * point_.forward;
    v.pick[kDiffuse] = mean(matte * (point_.base * (1 - point_.subsurface) + point_.under * back));
    v.pick[kDiffuseThrough] = mean(matte * (point_.filled ? kOne : point_.under) * through);
    float total = 0;
    for (const float p : v.pick) total += p;
    if (total > 0)
        for (float& p : v.pick) p /= total;
}

// Rough sheets, which let light pass straight on, and coats with a normal of their own count as diffuse.
ScatterOutline OpenPbrBsdf::outline(Vec3 wo) const noexcept {
    if (wo.z == 0 || (point_.filled && wo.z < 0)) return {};
    const View& v = view(wo);
    ScatterOutline result{.diffuse = v.pick[kFuzz] + v.pick[kDiffuse] + v.pick[kDiffuseThrough] + v.pick[kSheet]};
    if (point_.coatFrame)
        result.diffuse += v.pick[kCoat];
    else if (!point_.coat.smooth())
        result.add({.share = v.pick[kCoat], .alpha2 = square(point_.coat.ggx().alphaX())});
    if (smooth_) return result;
    const float reflected = reflectionShare(facet(v, Spectrum(v.wo.z))), eta = mean(point_.dielectric.eta());
    const float alpha2 = square(point_.specular.ggx().alphaX());
    result.add({.share = v.pick[kSpecular] * reflected, .alpha2 = alpha2});
    result.add({.share = v.pick[kSpecular] * (1 - reflected), .alpha2 = alpha2, .eta = v.within ? 1 / eta : eta});
    return result;
}

// A thin sheet reflects at both of its faces and all the times that light goes to and fro between them.
OpenPbrBsdf::Sheet OpenPbrBsdf::sheetFacet(Spectrum c) const {
    const Spectrum r = point_.dielectric.reflectance(c), enters = kOne - r;
    Spectrum t = point_.through;
    if (sheetAbsorbs_) {
        const Spectrum eta = point_.dielectric.eta();
        const Spectrum cos2 = kOne - (kOne - c) * (kOne + c) / (eta * eta);
        t = exp(log(max(t, Spectrum(1e-6f))) / sqrt(max(cos2, Spectrum(1e-4f))));
    }
    const Spectrum ladder = max(kOne - r * r * t * t, Spectrum(1e-6f));
    return {r + enters * enters * t * t * r / ladder, enters * enters * t / ladder};
}

} // namespace abbe
