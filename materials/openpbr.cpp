#include "materials/openpbr.h"

#include "materials/bent_normal.h"
#include "materials/interior_curves.h"
#include "materials/openpbr_bsdf.h"
#include "materials/sheen.h"
#include "math/frame.h"
#include "render/material.h"
#include "render/surface_hit.h"
#include "render/surface_input.h"
#include "schema/type.h"
#include "spectrum/curve.h"
#include "spectrum/dispersion.h"

#include <optional>

namespace abbe {

// The direction that an OpenPBR highlight is stretched along.

// `tangent`: turns from the texture's u, or a texture of directions along u and v, 0 … 1 for -1 … 1. In render space,
// of any length; across the unit normal n only about. Requires the parametrisation of the hit, without which shading.x
// stands for u.
Vec3 openPbrTangent(const schema::TexturedNumber& tangent, const SurfaceHit& hit, Vec3 n);

// The axes of an OpenPBR coat, where it has a normal or a tangent of its own.

// Immutable. Refers to the textures of the parameters.
class OpenPbrCoatFrame {
  public:
    explicit OpenPbrCoatFrame(const OpenPbrParams&);

    // Whether at() looks at the parametrisation of the hit.
    bool usesTextures() const { return ownNormal() || tangent_.texture || tangent_.value != 0 || baseTurned_; }
    // In hit.shading's axes; nothing where they are the same. Requires the parametrisation if usesTextures().
    std::optional<Frame> at(const SurfaceHit& hit) const;

  private:
    bool ownNormal() const { return normal_.texture || normal_.value < 1; }
    Vec3 normal(const SurfaceHit& hit) const;

    schema::TexturedNumber normal_, tangent_;
    bool baseTurned_; // the axes of the hit are those of the base, which has a tangent of its own
};

// What covers the light of an OpenPBR surface that emits: its coat and its fuzz [Andersson2024].

// The coat absorbs along the refracted way; fuzz lets through what it does not throw back. Refers to the coat's colour.
// Requires coats and fuzz without textures.
class OpenPbrVeil final : public EmissionVeil {
  public:
    explicit OpenPbrVeil(const OpenPbrParams&);
    // Whether there is anything to pass.
    static bool needed(const OpenPbrParams&);

    Spectrum passing(float cosine, const Wavelengths&) const noexcept override;

  private:
    float coat_, fuzz_; // shares covered
    const Curve* color_;
    float coatIor_;
    SheenLobe sheen_;
};

namespace {

// Cauchy's curve through n_d with the Abbe number V = (n_d - 1)/(n_F - n_C): lines of Fraunhofer, µm.
CauchyCurve cauchyOf(double index, double abbeNumber) {
    constexpr double f = 0.4861, d = 0.5876, c = 0.6563;
    const double b = (index - 1) / (abbeNumber * (1 / (f * f) - 1 / (c * c)));
    return {index - b / (d * d), b};
}

constexpr float kAny = 1e9f; // where a number has no upper limit

// Share of diffuse light from below that the surface of a coat in air returns.
float returnedByCoat(double ior) { return static_cast<float>(1 - (1 - hemisphericalReflectance(ior)) / (ior * ior)); }

class OpenPbr final : public Material {
  public:
    explicit OpenPbr(const OpenPbrParams&);

    const Bsdf* bsdf(const SurfaceHit&, const Wavelengths&, Arena&) const noexcept override;
    SurfaceEmission emission() const override {
        return {p_.emissionLuminance, p_.emissionColor.curve, p_.emissionColor.texture, p_.geometryThinWalled,
                veil_ ? &*veil_ : nullptr};
    }
    void bend(SurfaceHit& hit) const noexcept override {
        if (bends())
            hit.shading =
                Frame::fromNormalTangent(hit.shading.z, openPbrTangent(p_.geometryTangent, hit, hit.shading.z));
    }

  private:
    Effects effects() const;
    bool textured() const;
    bool refracts() const { return !p_.geometryThinWalled && !transmissionWeight_.is(0) && !baseMetalness_.is(1); }
    OpenPbrCover cover(const SurfaceHit&, const Wavelengths&) const;
    OpenPbrMetal metal(const SurfaceHit&, const Wavelengths&, const OpenPbrCover&) const;
    float coveredRoughness(const SurfaceHit&) const;
    GgxLobe specularLobe(const SurfaceHit&, float roughness) const;
    GgxLobe coatLobe(const SurfaceHit&) const;

    OpenPbrParams p_;
    NumberInput baseWeight_, baseDiffuseRoughness_, baseMetalness_, specularWeight_, specularRoughness_,
        specularRoughnessAnisotropy_, transmissionWeight_, subsurfaceWeight_, coatWeight_, coatRoughness_,
        coatRoughnessAnisotropy_, coatIor_, coatDarkening_, fuzzWeight_, fuzzRoughness_, thinFilmWeight_, thinFilmMap_,
        thinFilmIor_;
    SpectrumInput baseColor_, specularColor_, transmissionColor_, subsurfaceColor_, coatColor_, fuzzColor_;
    std::optional<CauchyCurve> cauchy_;
    ConstantCurve plainIor_{1.5};
    const Curve* ior_; // never null
    std::optional<AttenuationCurve> attenuation_;
    std::optional<OpenPbrVeil> veil_;
    bool filled_;       // with the medium of the subsurface part
    float coatReturns_; // unless the index is textured
    OpenPbrCoatFrame coatFrame_;
    std::optional<StretchedLobe> stretched_, stretchedCoat_;
    std::optional<StretchedInterface> stretchedGlass_;
};

OpenPbr::OpenPbr(const OpenPbrParams& p)
    : p_(p), baseWeight_(p.baseWeight, 0, 1), baseDiffuseRoughness_(p.baseDiffuseRoughness, 0, 1),
      baseMetalness_(p.baseMetalness, 0, 1), specularWeight_(p.specularWeight, 0, kAny),
      specularRoughness_(p.specularRoughness, 0, 1), specularRoughnessAnisotropy_(p.specularRoughnessAnisotropy, 0, 1),
      transmissionWeight_(p.transmissionWeight, 0, 1), subsurfaceWeight_(p.subsurfaceWeight, 0, 1),
      coatWeight_(p.coatWeight, 0, 1), coatRoughness_(p.coatRoughness, 0, 1),
      coatRoughnessAnisotropy_(p.coatRoughnessAnisotropy, 0, 1), coatIor_(p.coatIor, 0.2f, 10),
      coatDarkening_(p.coatDarkening, 0, 1), fuzzWeight_(p.fuzzWeight, 0, 1), fuzzRoughness_(p.fuzzRoughness, 0, 1),
      thinFilmWeight_(p.thinFilmWeight, 0, 1), thinFilmMap_(p.thinFilmMap, 0, kAny),
      thinFilmIor_(p.thinFilmIor, 0.2f, 10), baseColor_(p.baseColor, 0.8f), specularColor_(p.specularColor, 1),
      transmissionColor_(p.transmissionColor, 1), subsurfaceColor_(p.subsurfaceColor, 0.8f), coatColor_(p.coatColor, 1),
      fuzzColor_(p.fuzzColor, 1), ior_(p.specularIor ? p.specularIor : &plainIor_), filled_(hasSubsurfaceInside(p)),
      coatReturns_(returnedByCoat(p.coatIor.value)), coatFrame_(p) {
    if (OpenPbrVeil::needed(p)) veil_.emplace(p);
    if (p.transmissionDispersionScale > 0) {
        cauchy_.emplace(cauchyOf(ior_->at(587.6), p.transmissionDispersionAbbeNumber / p.transmissionDispersionScale));
        ior_ = &*cauchy_;
    }
    if (refracts() && !hasScatteringGlass(p) && p.transmissionDepth > 0 && p.transmissionColor.curve &&
        tints(p.transmissionColor))
        attenuation_.emplace(*p.transmissionColor.curve, p.transmissionDepth);
    const auto constant = [](const NumberInput& n) { return !n.textured(); };
    if (constant(specularRoughness_) && constant(specularRoughnessAnisotropy_) && constant(coatWeight_) &&
        constant(coatRoughness_)) {
        const Ggx ggx = Ggx::fromRoughness(coveredRoughness({}), specularRoughnessAnisotropy_.at({}));
        if (!ggx.smooth() && ggx.alphaX() != ggx.alphaY()) {
            stretched_.emplace(ggx.alphaX(), ggx.alphaY());
            const float weight = constant(specularWeight_) ? specularWeight_.at({}) : 1;
            const OpenPbrDielectric glass({}, Spectrum(static_cast<float>(ior_->at(587.6))), weight);
            if (refracts()) stretchedGlass_.emplace(ggx.alphaX(), ggx.alphaY(), glass.eta()[0]);
        }
    }
    if (!coatWeight_.is(0) && constant(coatRoughness_) && constant(coatRoughnessAnisotropy_)) {
        const Ggx ggx = Ggx::fromRoughness(coatRoughness_.at({}), coatRoughnessAnisotropy_.at({}));
        if (!ggx.smooth() && ggx.alphaX() != ggx.alphaY()) stretchedCoat_.emplace(ggx.alphaX(), ggx.alphaY());
    }
    traits_ = {.needs = effects(), .usesTextures = textured(), .bends = turnsTangent(p), .seesOutside = true};
    inside_ = {.absorption = attenuation_ ? &*attenuation_ : nullptr, .ior = refracts() ? ior_ : nullptr};
}

Effects OpenPbr::effects() const {
    Effects effects;
    if (refracts() && !ior_->isConstant()) effects |= Effect::dispersion;
    if (attenuation_) effects |= Effect::absorption;
    if (!thinFilmWeight_.is(0) && p_.thinFilmThickness > 0) effects |= Effect::thinFilm;
    return effects;
}

bool OpenPbr::textured() const {
    if (turnsTangent(p_) || (!coatWeight_.is(0) && coatFrame_.usesTextures())) return true;
    for (const NumberInput* n :
         {&baseWeight_, &baseDiffuseRoughness_, &baseMetalness_, &specularWeight_, &specularRoughness_,
          &specularRoughnessAnisotropy_, &transmissionWeight_, &subsurfaceWeight_, &coatWeight_, &coatRoughness_,
          &coatRoughnessAnisotropy_, &coatIor_, &coatDarkening_, &fuzzWeight_, &fuzzRoughness_, &thinFilmWeight_,
          &thinFilmMap_, &thinFilmIor_})
        if (n->textured()) return true;
    for (const SpectrumInput* s :
         {&baseColor_, &specularColor_, &transmissionColor_, &subsurfaceColor_, &coatColor_, &fuzzColor_})
        if (s->textured()) return true;
    return false;
}

OpenPbrCover OpenPbr::cover(const SurfaceHit& hit, const Wavelengths& lambda) const {
    OpenPbrCover c;
    c.coat = coatWeight_.at(hit);
    c.film = thinFilmWeight_.at(hit);
    if (hit.outside) c.outer = hit.outside->at(lambda);
    c.coatEta = Spectrum(coatIor_.at(hit)) / c.outer;
    c.filmIndex = Spectrum(thinFilmIor_.at(hit));
    c.filmThickness = static_cast<float>(p_.thinFilmThickness * 1e9) * thinFilmMap_.at(hit);
    c.wavelength = lambda.nm;
    c.varies = c.film > 0 || !ior_->isConstant() || (hit.outside && !hit.outside->isConstant());
    return c;
}

OpenPbrMetal OpenPbr::metal(const SurfaceHit& hit, const Wavelengths& lambda, const OpenPbrCover& cover) const {
    const float weight = specularWeight_.at(hit);
    if (p_.baseMetalIndex.n) return {cover, p_.baseMetalIndex.n->at(lambda), p_.baseMetalIndex.k->at(lambda), weight};
    return {cover, baseColor_.at(hit, lambda) * baseWeight_.at(hit), specularColor_.at(hit, lambda), weight, nullptr};
}

// A rough coat blurs what lies under it: widths add up like variances, twice that of the coat.
float OpenPbr::coveredRoughness(const SurfaceHit& hit) const {
    const float r = specularRoughness_.at(hit), coat = coatWeight_.at(hit);
    if (coat == 0) return r;
    const float both = square(square(r)) + 2 * square(square(coatRoughness_.at(hit)));
    return std::lerp(r, std::sqrt(std::sqrt(std::min(1.f, both))), coat);
}

GgxLobe OpenPbr::specularLobe(const SurfaceHit& hit, float roughness) const {
    return GgxLobe(Ggx::fromRoughness(roughness, specularRoughnessAnisotropy_.at(hit)),
                   stretched_ ? &*stretched_ : nullptr, stretchedGlass_ ? &*stretchedGlass_ : nullptr);
}

GgxLobe OpenPbr::coatLobe(const SurfaceHit& hit) const {
    return GgxLobe(Ggx::fromRoughness(coatRoughness_.at(hit), coatRoughnessAnisotropy_.at(hit)),
                   stretchedCoat_ ? &*stretchedCoat_ : nullptr);
}

const Bsdf* OpenPbr::bsdf(const SurfaceHit& hit, const Wavelengths& lambda, Arena& arena) const noexcept {
    const OpenPbrCover covering = cover(hit, lambda);
    const float roughness = coveredRoughness(hit), transmission = transmissionWeight_.at(hit);
    const Spectrum one(1.f), index = ior_->at(lambda);
    const OpenPbrDielectric dielectric(covering, index, specularWeight_.at(hit));
    const GgxLobe specular = specularLobe(hit, roughness);
    const bool tinted = transmission > 0 && (p_.geometryThinWalled || p_.transmissionDepth == 0);
    // Light through a sheet is bent once to, once fro by slopes that do not know each other: small angles deviate by
    // √2 |η - 1| times the slope, a reflection by twice it.
    const float bend = std::min(1.f, mean(abs(dielectric.eta() - one)) * 0.70710678f);
    const Ggx through = Ggx::fromRoughness(std::sqrt(specular.ggx().alphaX() * bend), 0);
    return arena.make<OpenPbrBsdf>(OpenPbrPoint{
        .metalness = baseMetalness_.at(hit),
        .transmission = transmission,
        .subsurface = subsurfaceWeight_.at(hit),
        .thinWalled = p_.geometryThinWalled,
        .filled = filled_,
        .forward = filled_ ? 1 : static_cast<float>(0.5 * (1 + p_.subsurfaceScatterAnisotropy)),
        .base = baseColor_.at(hit, lambda) * baseWeight_.at(hit),
        .under = subsurfaceColor_.at(hit, lambda),
        .tint = specularColor_.at(hit, lambda),
        .through = tinted ? transmissionColor_.at(hit, lambda) : one,
        .coatLog = covering.coat > 0 && tints(p_.coatColor)
                       ? 0.5f * log(max(coatColor_.at(hit, lambda), Spectrum(1e-6f)))
                       : Spectrum(0.f),
        .diffuseRoughness = baseDiffuseRoughness_.at(hit),
        .roughness = roughness,
        .coatDarkening = coatDarkening_.at(hit),
        .coatReturns = coatIor_.textured() ? returnedByCoat(static_cast<double>(coatIor_.at(hit))) : coatReturns_,
        .fuzz = fuzzWeight_.at(hit),
        .fuzzColor = fuzzColor_.at(hit, lambda),
        .sheen = SheenLobe(fuzzRoughness_.at(hit)),
        .coatFrame = covering.coat > 0 ? coatFrame_.at(hit) : std::nullopt,
        .cover = covering,
        .dielectric = dielectric,
        .metal = metal(hit, lambda, covering),
        .specular = specular,
        .coat = coatLobe(hit),
        .sheet = GgxLobe(through),
    });
}

} // namespace

std::unique_ptr<const Material> makeOpenPbr(const OpenPbrParams& params) { return std::make_unique<OpenPbr>(params); }

Vec3 openPbrTangent(const schema::TexturedNumber& tangent, const SurfaceHit& hit, Vec3 n) {
    const bool known = lengthSquared(hit.dpdu) > 0;
    const Frame along = Frame::fromNormalTangent(n, known ? hit.dpdu : hit.shading.x);
    const float side = known && dot(along.y, hit.dpdv) < 0 ? -1.f : 1.f; // mirrored texture coordinates
    if (!tangent.texture) {
        const float angle = 2 * kPi * static_cast<float>(tangent.value);
        return along.x * std::cos(angle) + along.y * (side * std::sin(angle));
    }
    const TextureWork work;
    const Vec3 stored = tangent.texture->value(TextureQuery(hit));
    return along.x * (2 * stored.x - 1) + along.y * (side * (2 * stored.y - 1));
}

OpenPbrCoatFrame::OpenPbrCoatFrame(const OpenPbrParams& p)
    : normal_(p.geometryCoatNormal), tangent_(p.geometryCoatTangent), baseTurned_(turnsTangent(p)) {}

// What the material wears has bent the hit's normal; the shape's own is known in its space.
Vec3 OpenPbrCoatFrame::normal(const SurfaceHit& hit) const {
    if (!ownNormal()) return hit.shading.z;
    const Vec3 l = hit.localNormal, own = hit.localX * l.x + hit.localY * l.y + hit.localZ * l.z;
    const float l2 = lengthSquared(own);
    if (!(l2 > 0)) return hit.shading.z;
    SurfaceHit plain = hit;
    plain.shading.z = own * ((dot(own, hit.ng) < 0 ? -1 : 1) / std::sqrt(l2));
    const auto follow = static_cast<float>(normal_.value);
    const Vec3 n = normal_.texture ? mappedNormal({normal_.texture, 1}, plain)
                                   : normalize(plain.shading.z * (1 - follow) + hit.shading.z * follow);
    return consistentNormal(hit.ng, n, -hit.arrival);
}

std::optional<Frame> OpenPbrCoatFrame::at(const SurfaceHit& hit) const {
    if (!usesTextures()) return std::nullopt;
    const Vec3 n = normal(hit);
    const Frame own = Frame::fromNormalTangent(n, openPbrTangent(tangent_, hit, n)), &base = hit.shading;
    return Frame{base.toLocal(own.x), base.toLocal(own.y), base.toLocal(own.z)};
}

OpenPbrVeil::OpenPbrVeil(const OpenPbrParams& p)
    : coat_(tints(p.coatColor) ? static_cast<float>(p.coatWeight.value) : 0),
      fuzz_(static_cast<float>(p.fuzzWeight.value)), color_(p.coatColor.curve),
      coatIor_(static_cast<float>(p.coatIor.value)), sheen_(static_cast<float>(p.fuzzRoughness.value)) {}

bool OpenPbrVeil::needed(const OpenPbrParams& p) {
    return p.emissionLuminance > 0 && ((p.coatWeight.value > 0 && tints(p.coatColor)) || p.fuzzWeight.value > 0);
}

Spectrum OpenPbrVeil::passing(float cosine, const Wavelengths& lambda) const noexcept {
    Spectrum share(1 - fuzz_ * sheen_.albedo(cosine));
    if (!(coat_ > 0)) return share;
    const float sine2 = (1 - cosine) * (1 + cosine) / square(coatIor_);
    const float inside = std::sqrt(std::max(1 - sine2, 1e-6f)); // as OpenPbrCover::cosineInCoat
    const Spectrum way = log(max(color_->at(lambda), Spectrum(1e-6f))) * (0.5f / inside);
    return share * fma(exp(way) - Spectrum(1.f), Spectrum(coat_), Spectrum(1.f));
}

} // namespace abbe
