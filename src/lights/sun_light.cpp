#include "lights/sun_light.h"

#include "lights/amount.h"
#include "lights/light_context.h"
#include "math/warp.h"

#include <cmath>

namespace abbe {

std::optional<Vec3d> sunDirection(const SunPlace& place, bool zUp, Span span, Diagnostics& diagnostics) {
    if (place.toward && (place.elevation || place.azimuth)) {
        diagnostics.error("E0346", span, "the sun's direction is stated twice",
                          "keep `toward`, or `elevation` and `azimuth`");
        return std::nullopt;
    }
    if (place.toward) {
        const double norm = length(*place.toward);
        if (norm > 0 && std::isfinite(norm)) return *place.toward * (-1 / norm);
        diagnostics.error("E0344", span, "the sun has no direction", "`toward` is zero");
        return std::nullopt;
    }
    const double elevation = place.elevation.value_or(kPiD / 4), azimuth = place.azimuth.value_or(0.75 * kPiD);
    const double east = std::cos(elevation) * std::sin(azimuth), north = std::cos(elevation) * std::cos(azimuth);
    const double up = std::sin(elevation);
    return zUp ? Vec3d{east, north, up} : Vec3d{east, up, -north};
}

namespace {

using schema::Dimension;
using schema::FieldType;
constexpr AmountFields kSunAmounts =
    AmountFields(AmountField::irradiance) | AmountField::luminance | AmountField::radiance;
constexpr double kDefaultIrradiance = 100000; // lx: the sun in a clear sky

std::vector<schema::FieldInfo> directionFields() {
    std::vector<schema::FieldInfo> fields = sunPlaceFields<SunLightParams>();
    fields.push_back(schema::field(FieldType::quantity, "angular-diameter", &SunLightParams::angularDiameter)
                         .unit({Dimension::angle})
                         .byDefault("0.53 deg")
                         .range(0, 180 * kDegree)
                         .doc("Full angle of the disk; below 0.001 deg the light comes from a single direction.")
                         .example("angular-diameter 2 deg")
                         .synonyms({"angle", "size"}));
    return fields;
}

} // namespace

schema::TypeInfo sunLightType() {
    schema::TypeInfo type{.kind = schema::Kind::light,
                          .name = "sun",
                          .doc =
                              "A distant disk of even radiance. Without an amount: 100 klx on a surface that faces it.",
                          .example = "light sun { elevation 30 deg; azimuth 240 deg; irradiance 100 klx }",
                          .fields = directionFields()};
    addAmountFields<SunLightParams>(type.fields, kSunAmounts);
    type.fields.push_back(distantVisibleField<SunLightParams>());
    type.fields.push_back(schema::field(FieldType::transform, "transform", &SunLightParams::transform)
                              .doc("Turns the light; only the rotation matters.")
                              .example("transform { rotate y 30 deg }")
                              .synonyms({"to-world", "matrix"}));
    return type;
}

SunLight::SunLight(Vec3d direction, double halfAngle, ScaledCurve irradiance)
    : frame_(Frame::fromNormal(Vec3(normalize(direction)))), delta_(halfAngle < kSmallestHalfAngle),
      irradiance_(radiantIntegral(*irradiance.curve) * irradiance.scale),
      visibleIrradiance_(visibleIntegral(*irradiance.curve) * irradiance.scale) {
    // 1 - cos by the half-angle formula, in double: no cancellation for small disks.
    const double oneMinusCosine = 2 * square(std::sin(halfAngle / 2));
    oneMinusCos_ = delta_ ? 0 : static_cast<float>(oneMinusCosine);
    chord_ = static_cast<float>(2 * std::sin(halfAngle / 2));
    pdf_ = delta_ ? 0 : static_cast<float>(1 / (2 * kPiD * oneMinusCosine));
    radiance_ = irradiance;
    if (!delta_) radiance_.scale /= kPiD * square(std::sin(halfAngle));
    commit(Bounds3{});
}

void SunLight::commit(const Bounds3& bounds) { power_ = irradiance_ * sceneDiskArea(bounds); }

bool SunLight::inside(Vec3 w) const noexcept {
    // The chord of the angle: the small difference is formed before squaring, so that nothing cancels.
    return length(w - frame_.z) <= chord_;
}

std::optional<LightSample> SunLight::sample(const Receiver&, std::uint32_t, Vec2 u, const Wavelengths& lambda,
                                            float) const noexcept {
    const Vec3 wi = delta_ ? frame_.z : frame_.toWorld(squareToCone(u, oneMinusCos_));
    return std::optional<LightSample>(std::in_place, wi, Vec3{}, kInfinity, radiance_.at(lambda), delta_ ? 1 : pdf_,
                                      delta_);
}

Spectrum SunLight::escaped(Vec3 w, const Wavelengths& lambda, float) const noexcept {
    return !delta_ && inside(w) ? radiance_.at(lambda) : Spectrum(0.f);
}

float SunLight::pdfEscaped(const Receiver&, Vec3 w, float) const noexcept { return inside(w) ? pdf_ : 0; }

// The disk's edge shines on surfaces that its middle does not reach.
float SunLight::inSight(const Receiver& from) const noexcept {
    const float facing = from.oneSided() ? std::clamp(dot(from.n, frame_.z) + chord_, 0.f, 1.f) : 1;
    if (!windows_ || !windows_->inside(from.p) || windows_->cross(from.p, frame_.z)) return facing;
    return facing * kBesidePortals;
}

std::unique_ptr<DistantLight> makeSunLight(const SunLightParams& params, const LightContext& context,
                                           Diagnostics& diagnostics) {
    const auto place = sunDirection(params, context.zUp, context.span, diagnostics);
    if (!place) return nullptr;
    const Transform toRender = params.transform.at(context.time).then(context.toRender);
    const Vec3d direction = toRender.vector(*place);
    const double norm = length(direction);
    if (!(norm > 0 && std::isfinite(norm))) {
        diagnostics.error("E0344", context.span, "the sun has no direction", "its transform leaves none");
        return nullptr;
    }
    const double halfAngle = params.angularDiameter / 2;
    const double projected = kPiD * square(std::sin(halfAngle)); // ∫ cos dω over the disk
    const bool delta = halfAngle < SunLight::kSmallestHalfAngle;
    if (delta && (params.luminance || params.hasRadiance())) {
        diagnostics.error("E0347", context.span, "a sun without a diameter has no luminance",
                          "state its `irradiance`, or an `angular-diameter`");
        return nullptr;
    }
    AmountParams amount = params;
    if (!amount.stated()) amount.irradiance = {kDefaultIrradiance, Dimension::illuminance, {}};
    // The spectrum of the irradiance: for the other amounts, radiance times the projected solid angle.
    auto irradiance = absoluteSpectrum(amount, *context.defaultColor, {.irradiance = 1, .range = kIrradianceRange},
                                       context.span, diagnostics);
    if (!irradiance) return nullptr;
    if (!amount.irradiance) irradiance->scale *= projected;
    return std::make_unique<SunLight>(direction, halfAngle, *irradiance);
}

} // namespace abbe
