#include "lights/sky_light.h"

#include "lights/amount.h"
#include "lights/light_context.h"
#include "math/frame.h"
#include "math/warp.h"

#include <fmt/format.h>

namespace abbe {

namespace {
constexpr AmountFields kSkyAmounts =
    AmountFields(AmountField::radiance) | AmountField::luminance | AmountField::irradiance;
}

schema::TypeInfo skyLightType() {
    schema::TypeInfo type{.kind = schema::Kind::light,
                          .name = "sky",
                          .doc =
                              "The same light from all directions. Without an amount: 20 000 nits, a bright hazy sky; "
                              "`irradiance` is that of an open surface.",
                          .example = "light sky { luminance 8000 nits }",
                          .fields = {}};
    addAmountFields<SkyLightParams>(type.fields, kSkyAmounts);
    type.fields.push_back(portalsField<SkyLightParams>());
    type.fields.push_back(distantVisibleField<SkyLightParams>());
    return type;
}

SkyLight::SkyLight(ScaledCurve radiance)
    : radiance_(radiance), radiant_(radiantIntegral(*radiance.curve) * radiance.scale), power_(0) {
    irradiance_ = kPiD * visibleIntegral(*radiance.curve) * radiance.scale;
    commit(Bounds3{});
}

void SkyLight::commit(const Bounds3& bounds) { power_ = 4 * kPiD * radiant_ * sceneDiskArea(bounds); }

std::optional<LightSample> SkyLight::sample(const Receiver& from, std::uint32_t, Vec2 u, const Wavelengths& lambda,
                                            float) const noexcept {
    const Vec3 wi =
        from.oneSided() ? normalize(Frame::fromNormal(from.n).toWorld(squareToCosineHemisphere(u))) : squareToSphere(u);
    const float pdf = pdfEscaped(from, wi, 0);
    if (!(pdf > 0)) return std::nullopt; // along the surface
    return std::optional<LightSample>(std::in_place, wi, Vec3{}, kInfinity, radiance_.at(lambda), pdf);
}

// An opaque surface gets light in proportion to the cosine; what lies behind it counts for nothing.
float SkyLight::pdfEscaped(const Receiver& from, Vec3 w, float) const noexcept {
    return from.oneSided() ? cosineHemispherePdf(dot(w, from.n)) : kSpherePdf;
}

std::unique_ptr<DistantLight> makeSkyLight(const SkyLightParams& params, const LightContext& context,
                                           Diagnostics& diagnostics) {
    AmountParams amount = params;
    if (!amount.stated()) amount.luminance = {kDefaultSkyLuminance, schema::Dimension::luminance, {}};
    const auto radiance = absoluteSpectrum(amount, *context.defaultColor, {.irradiance = kPiD, .range = kSkyRadiance},
                                           context.span, diagnostics);
    if (!radiance) return nullptr;
    return throughWindows(std::make_unique<SkyLight>(*radiance), params, context, {}, diagnostics);
}

} // namespace abbe
