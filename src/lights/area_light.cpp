#include "lights/area_light.h"

#include "lights/area_light_types.h"
#include "lights/light_context.h"
#include "lights/moving_light.h"
#include "math/frame.h"
#include "math/warp.h"

namespace abbe {

namespace {

// In the mean over the light that leaves an even surface, 2∫ f(µ) µ dµ, at even steps of µ².
SampledCurve veiledSpectrum(const Curve& spectrum, const EmissionVeil& veil) {
    constexpr int kPoints = 8;
    return SampledCurve([&](double nm) {
        const auto lambda = Wavelengths::single(static_cast<float>(nm));
        double sum = 0;
        for (int i = 0; i < kPoints; ++i)
            sum += static_cast<double>(veil.passing(std::sqrt((static_cast<float>(i) + 0.5f) / kPoints), lambda)[0]);
        return spectrum.at(nm) * sum / kPoints;
    });
}

} // namespace

AreaLight::AreaLight(const Shape& shape, ScaledCurve radiance, bool twoSided,
                     std::unique_ptr<const LightTexture> texture, const EmissionVeil* veil)
    : shape_(shape), sampling_(shape), centre_(shape.bounds().centre()), radiance_(radiance),
      texture_(std::move(texture)), veil_(veil), twoSided_(twoSided) {
    if (veil_) veiled_.emplace(veiledSpectrum(*unveiled(), *veil_));
    const double area = shape.area();
    const double spread = std::isfinite(area) ? (twoSided ? 2 : 1) * kPiD * area * radiance.scale : 0;
    const Curve& mean = veiled_ ? *veiled_ : *unveiled();
    power_ = spread * radiantIntegral(mean);
    visiblePower_ = spread * visibleIntegral(mean);
}

std::optional<LightBounds> AreaLight::bounds(std::uint32_t part) const {
    if (!(power_ > 0)) return std::nullopt;
    const EmitterPart p = sampling_->emitterPart(part);
    const double share = texture_ ? texture_->share(part) : p.area / shape_.area();
    return LightBounds{.box = p.box,
                       .axis = p.axis,
                       .cosNormals = p.cosNormals,
                       .cosEmission = 0,
                       .twoSided = twoSided_,
                       .power = static_cast<float>(visiblePower_ * share)};
}

std::optional<LightSample> AreaLight::sample(const Receiver& from, std::uint32_t part, Vec2 u,
                                             const Wavelengths& lambda, float) const noexcept {
    Spectrum factor(1.f);
    const std::optional<ShapeSample> s = point(from, part, u, lambda, factor);
    if (!s) return std::nullopt;
    return arriving(*s, from.p, lambda, factor);
}

std::optional<ShapeSample> AreaLight::point(const Receiver& from, std::uint32_t part, Vec2 u, const Wavelengths& lambda,
                                            Spectrum& factor) const noexcept {
    if (!texture_) [[likely]]
        return sampling_->sample(from, part, u);
    return texture_->sample(from, part, u, lambda, factor);
}

std::optional<LightReach> AreaLight::reach(const Ray&, float tMax) const noexcept {
    if (!(power_ > 0) || !isFinite(centre_)) return std::nullopt;
    return LightReach{centre_, 0, tMax};
}

std::optional<LightSample> AreaLight::arriving(const ShapeSample& s, Vec3 from, const Wavelengths& lambda,
                                               const Spectrum& factor) const noexcept {
    if (!(s.pdfSolidAngle > 0) || !(s.pdfSolidAngle < kInfinity)) return std::nullopt;
    const Vec3 offset = s.p - from;
    const float distance = length(offset);
    if (!(distance > 0)) return std::nullopt;
    const Vec3 wi = offset * (1 / distance);
    if (!emits(s.ng, -wi)) return std::nullopt;
    // The end of a shadow ray is as uncertain as its direction: without a margin of a few roundings of the distance,
    // half of all rays to a far sphere or disk would end behind its surface.
    const float rounding = 0x1p-21f * distance;
    const Vec3 p = spawnOrigin(s.p, s.pError + Vec3{rounding, rounding, rounding}, s.ng, -wi);
    // In place, as every Bsdf::sample (render/bsdf.h).
    std::optional<LightSample> sample(std::in_place, wi, p, distance, radiance(dot(s.ng, wi), lambda) * factor,
                                      s.pdfSolidAngle);
    sample->n = s.ng;
    return sample;
}

Spectrum AreaLight::emitted(const SurfaceHit& hit, Vec3 w, const Wavelengths& lambda) const noexcept {
    if (!emits(hit.ng, w)) return Spectrum(0.f);
    const Spectrum plain = radiance(dot(hit.ng, w), lambda);
    return texture_ ? plain * texture_->at(hit, lambda) : plain;
}

Spectrum AreaLight::radiance(float cosine, const Wavelengths& lambda) const noexcept {
    const Spectrum plain = radiance_.at(lambda);
    return veil_ ? plain * veil_->passing(std::min(std::abs(cosine), 1.f), lambda) : plain;
}

float AreaLight::pdfSolidAngle(const Receiver& from, const SurfaceHit& hit, float) const noexcept {
    if (!emits(hit.ng, from.p - hit.p)) return 0;
    const float pdf = texture_ ? texture_->pdfSolidAngle(from, hit) : sampling_->pdfSolidAngle(from, hit);
    return pdf < kInfinity ? pdf : 0; // as in sample
}

float AreaLight::pdfAtPoint(const Receiver& from, std::uint32_t part, Vec3 p, Vec3 n, float time) const noexcept {
    std::optional<SurfaceHit> hit;
    if (texture_) { // whose density needs its coordinates
        hit = texture_->hitAt(p, n, part);
        if (!hit) return 0;
    } else {
        hit.emplace();
        hit->p = p;
        hit->ng = n;
    }
    hit->primitive = part;
    return AreaLight::pdfSolidAngle(from, *hit, time);
}

LightOrigin AreaLight::originOf(Vec3 p, Vec3 n, float pdf, float time) const noexcept {
    LightOrigin origin;
    origin.p = p;
    origin.n = n;
    origin.pdf = pdf;
    origin.largest = twoSided_ ? 0.5f * kInvPi : kInvPi; // along the normal
    origin.sides = twoSided_ ? LightOrigin::Sides::both : LightOrigin::Sides::front;
    origin.time = time;
    return origin;
}

std::optional<LightOrigin> AreaLight::sampleOrigin(std::uint32_t part, Vec2 u, const Wavelengths& lambda,
                                                   float time) const noexcept {
    Spectrum factor(1.f);
    const auto s = texture_ ? texture_->samplePoint(part, u, lambda, factor) : sampling_->samplePoint(part, u);
    if (!s || !(s->pdfArea > 0) || !(s->pdfArea < kInfinity)) return std::nullopt;
    LightOrigin origin = originOf(s->p, s->ng, s->pdfArea, time);
    origin.pError = s->pError;
    origin.factor = factor;
    return origin;
}

LightOrigin AreaLight::originAt(std::uint32_t part, Vec3 p, Vec3 n, float time) const noexcept {
    const float pdf = texture_ ? texture_->pdfPoint(part, p, n) : sampling_->pdfPoint(part, n);
    return originOf(p, n, pdf < kInfinity ? pdf : 0, time); // as in sampleOrigin
}

Vec3 AreaLight::sampleDirection(const LightOrigin& origin, Vec2 u) const noexcept {
    const bool back = twoSided_ && !(u.x < 0.5f);
    if (twoSided_) u.x = back ? 2 * u.x - 1 : 2 * u.x;
    return Frame::fromNormal(back ? -origin.n : origin.n).toWorld(squareToCosineHemisphere(u));
}

float AreaLight::pdfDirection(const LightOrigin& origin, Vec3 w) const noexcept {
    const float cosine = dot(origin.n, w);
    return twoSided_ ? 0.5f * kInvPi * std::abs(cosine) : cosineHemispherePdf(cosine);
}

Spectrum AreaLight::leaving(const LightOrigin& origin, Vec3 w, const Wavelengths& lambda) const noexcept {
    return emits(origin.n, w) ? radiance(dot(origin.n, w), lambda) * origin.factor : Spectrum(0.f);
}

std::unique_ptr<SurfaceLight> makeAreaLight(const AreaLightParams& params, const Shape& shape,
                                            const LightContext& context, Diagnostics& diagnostics) {
    if (!params.stated()) {
        reportMissingAmount(kAreaAmounts, context.span, diagnostics);
        return nullptr;
    }
    AmountParams amount = params;
    if (params.radiance.texture) amount.radiance = {context.textureWhite, nullptr, params.radiance.span};
    const double sides = params.twoSided ? 2 : 1;
    const EmitterFactors factors{.power = sides * kPiD * shape.area()};
    std::unique_ptr<const LightTexture> texture;
    std::optional<ScaledCurve> radiance;
    if (context.texture) {
        const Curve& curve = amount.radiance.curve ? *amount.radiance.curve
                             : amount.color        ? *amount.color
                                                   : *context.defaultColor;
        texture =
            std::make_unique<const LightTexture>(shape, *context.texture, context.toOwn, curve, context.texturesOpen);
        if (amount.power) amount.color = &texture->spectrum();
        if (texture->black())
            radiance = ScaledCurve{&curve, 0};
        else if ((radiance = absoluteSpectrum(amount, *context.defaultColor, factors, context.span, diagnostics)))
            radiance->curve = &curve;
    } else {
        radiance = absoluteSpectrum(amount, *context.defaultColor, factors, context.span, diagnostics);
    }
    if (!radiance) return nullptr;
    if (context.motion)
        return std::make_unique<MovingAreaLight>(shape, *radiance, params.twoSided, *context.motion,
                                                 std::move(texture));
    return std::make_unique<AreaLight>(shape, *radiance, params.twoSided, std::move(texture));
}

} // namespace abbe
