#include "lights/area_light.h"

#include "lights/area_light_types.h"
#include "lights/light_context.h"
#include "lights/moving_light.h"

namespace abbe {

AreaLight::AreaLight(const Shape& shape, ScaledCurve radiance, bool twoSided)
    : shape_(shape), centre_(shape.bounds().centre()), radiance_(radiance), twoSided_(twoSided) {
    const double area = shape.area();
    const double spread = std::isfinite(area) ? (twoSided ? 2 : 1) * kPiD * area * radiance.scale : 0;
    power_ = spread * radiantIntegral(*radiance.curve);
    visiblePower_ = spread * visibleIntegral(*radiance.curve);
}

std::optional<LightBounds> AreaLight::bounds(std::uint32_t part) const {
    if (!(power_ > 0)) return std::nullopt;
    const EmitterPart p = shape_.emitterPart(part);
    return LightBounds{.box = p.box,
                       .axis = p.axis,
                       .cosNormals = p.cosNormals,
                       .cosEmission = 0,
                       .twoSided = twoSided_,
                       .power = static_cast<float>(visiblePower_ * p.area / shape_.area())};
}

std::optional<LightSample> AreaLight::sample(const Receiver& from, std::uint32_t part, Vec2 u,
                                             const Wavelengths& lambda, float) const noexcept {
    const std::optional<ShapeSample> s = shape_.sample(from, part, u);
    if (!s) return std::nullopt;
    return arriving(*s, from.p, lambda);
}

std::optional<LightReach> AreaLight::reach(const Ray&, float tMax) const noexcept {
    if (!(power_ > 0) || !isFinite(centre_)) return std::nullopt;
    return LightReach{centre_, 0, tMax};
}

std::optional<LightSample> AreaLight::arriving(const ShapeSample& s, Vec3 from,
                                               const Wavelengths& lambda) const noexcept {
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
    return std::optional<LightSample>(std::in_place, wi, p, distance, radiance_.at(lambda), s.pdfSolidAngle);
}

Spectrum AreaLight::emitted(const SurfaceHit& hit, Vec3 w, const Wavelengths& lambda) const noexcept {
    return emits(hit.ng, w) ? radiance_.at(lambda) : Spectrum(0.f);
}

float AreaLight::pdfSolidAngle(const Receiver& from, const SurfaceHit& hit, float) const noexcept {
    if (!emits(hit.ng, from.p - hit.p)) return 0;
    const float pdf = shape_.pdfSolidAngle(from, hit);
    return pdf < kInfinity ? pdf : 0; // as in sample
}

std::unique_ptr<Light> makeAreaLight(const AreaLightParams& params, const Shape& shape, const LightContext& context,
                                     Diagnostics& diagnostics) {
    if (!params.stated()) {
        reportMissingAmount(kAreaAmounts, context.span, diagnostics);
        return nullptr;
    }
    const double sides = params.twoSided ? 2 : 1;
    const auto radiance = absoluteSpectrum(params, *context.defaultColor, {.power = sides * kPiD * shape.area()},
                                           context.span, diagnostics);
    if (!radiance) return nullptr;
    if (context.motion) return std::make_unique<MovingAreaLight>(shape, *radiance, params.twoSided, *context.motion);
    return std::make_unique<AreaLight>(shape, *radiance, params.twoSided);
}

} // namespace abbe
