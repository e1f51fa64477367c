#include "lights/spot_light.h"

#include "lights/amount.h"
#include "math/frame.h"

#include <fmt/format.h>

namespace abbe {

namespace {

using schema::Dimension;
using schema::FieldType;

constexpr AmountFields kSpotAmounts = AmountFields(AmountField::power) | AmountField::intensity;

// 1 - cos x without cancellation.
double oneMinusCosine(double x) { return 2 * square(std::sin(x / 2)); }

std::vector<schema::FieldInfo> coneFields() {
    return {schema::field(FieldType::quantity, "angle", &SpotLightParams::angle)
                .unit({Dimension::angle})
                .byDefault("45 deg")
                .range(0.01 * kDegree, 360 * kDegree)
                .doc("Full angle of the cone outside of which there is no light.")
                .example("angle 40 deg")
                .synonyms({"coneangle", "cone-angle", "cutoff", "outer-angle", "spot-size"}),
            schema::field(FieldType::quantity, "inner-angle", &SpotLightParams::innerAngle)
                .unit({Dimension::angle})
                .range(0, 360 * kDegree)
                .doc("Full angle of the cone with even light; towards `angle` it falls smoothly. Default: 0.8 `angle`.")
                .example("inner-angle 30 deg")
                .synonyms({"penumbra", "conedeltaangle", "beam-width", "blend"})};
}

} // namespace

schema::TypeInfo spotLightType() {
    schema::TypeInfo type{.kind = schema::Kind::light,
                          .name = "spot",
                          .doc = "A point that emits into a cone with a soft edge.",
                          .example = "light spot { position 0 3 0; look-at 0 0 0; angle 40 deg; intensity 500 cd }",
                          .fields = {}};
    type.fields.push_back(schema::field(FieldType::vector3, "position", &SpotLightParams::position)
                              .unit({Dimension::length})
                              .byDefault("0 0 0")
                              .doc("Where the light is.")
                              .example("position 0 3 0")
                              .synonyms({"from", "center", "location"}));
    type.fields.push_back(schema::field(FieldType::vector3, "look-at", &SpotLightParams::lookAt)
                              .unit({Dimension::length})
                              .group("axis")
                              .doc("A point on the axis of the cone.")
                              .example("look-at 0 0 0")
                              .synonyms({"to", "target"}));
    type.fields.push_back(schema::field(FieldType::vector3, "toward", &SpotLightParams::toward)
                              .group("axis")
                              .doc("Direction of the axis, of any length. Without `look-at`: 0 0 -1.")
                              .example("toward 0 -1 0")
                              .synonyms({"direction", "axis"}));
    for (schema::FieldInfo& f : coneFields()) type.fields.push_back(std::move(f));
    addAmountFields<SpotLightParams>(type.fields, kSpotAmounts);
    type.fields.push_back(schema::field(FieldType::transform, "transform", &SpotLightParams::transform)
                              .doc("Places the light: steps from top to bottom, as applied to it.")
                              .example("transform { translate 0 2 0 }")
                              .synonyms({"to-world", "matrix"}));
    return type;
}

SpotLight::SpotLight(Vec3 position, Vec3 axis, double innerHalfAngle, double outerHalfAngle, ScaledCurve intensity)
    : position_(position), axis_(axis), innerOneMinusCos_(static_cast<float>(oneMinusCosine(innerHalfAngle))),
      outerOneMinusCos_(static_cast<float>(oneMinusCosine(outerHalfAngle))), intensity_(intensity),
      power_(solidAngle(innerHalfAngle, outerHalfAngle) * radiantIntegral(*intensity.curve) * intensity.scale),
      visiblePower_(solidAngle(innerHalfAngle, outerHalfAngle) * visibleIntegral(*intensity.curve) * intensity.scale) {}

double SpotLight::solidAngle(double innerHalfAngle, double outerHalfAngle) {
    // The falloff is a cubic step in cos θ, whose mean is 1/2.
    return kPiD * (oneMinusCosine(innerHalfAngle) + oneMinusCosine(outerHalfAngle));
}

float SpotLight::falloff(Vec3 w) const noexcept {
    const float h = lengthSquared(w - axis_) / 2; // 1 - cos θ of unit vectors, exact for small angles
    if (h >= outerOneMinusCos_) return 0;
    if (h <= innerOneMinusCos_) return 1;
    const float t = (outerOneMinusCos_ - h) / (outerOneMinusCos_ - innerOneMinusCos_);
    return t * t * (3 - 2 * t);
}

std::optional<LightSample> SpotLight::sample(const Receiver& from, std::uint32_t, Vec2, const Wavelengths& lambda,
                                             float) const noexcept {
    const Vec3 offset = position_ - from.p;
    const float d2 = lengthSquared(offset);
    if (!(d2 >= std::numeric_limits<float>::min())) return std::nullopt; // at the light: no direction
    const float distance = std::sqrt(d2);
    const Vec3 wi = offset / distance;
    const float f = falloff(-wi);
    if (f == 0) return std::nullopt;
    return std::optional<LightSample>(std::in_place, wi, position_, distance, intensity_.at(lambda) * (f / d2), 1.f,
                                      true);
}

// With the axis a and v = origin - apex + t d: inside the cone where |v × a|² <= tan² (v · a)² and v · a > 0.
std::optional<LightReach> SpotLight::reach(const Ray& ray, float tMax) const noexcept {
    const LightReach whole{position_, 0, tMax};
    const double cosine = 1 - static_cast<double>(outerOneMinusCos_);
    if (cosine < 0.1) return whole; // not convex, or so wide that it cuts little off
    const double tangent2 = 1.001 * (1 / (cosine * cosine) - 1);
    const Vec3d a(axis_), d(ray.direction), o = Vec3d(ray.origin) - Vec3d(position_);
    const Vec3d da = cross(d, a), oa = cross(o, a);
    const double along = dot(d, a), height = dot(o, a);
    const double qa = dot(da, da) - tangent2 * along * along, qb = dot(da, oa) - tangent2 * along * height;
    const double qc = dot(oa, oa) - tangent2 * height * height, discriminant = qb * qb - qa * qc;
    if (std::abs(qa) < 1e-12) return whole;
    if (discriminant < 0) return std::nullopt; // of a ray that passes both halves of the double cone by
    const double q = -(qb + std::copysign(std::sqrt(discriminant), qb));
    const double r1 = q / qa, r2 = q != 0 ? qc / q : r1;
    double from = std::min(r1, r2), to = std::max(r1, r2);
    if (qa > 0) {
        if (height + 0.5 * (from + to) * along <= 0) return std::nullopt; // through the other half
    } else if (along > 0) {
        from = to;
        to = static_cast<double>(tMax);
    } else {
        to = from;
        from = 0;
    }
    from = std::max(from, 0.0);
    to = std::min(to, static_cast<double>(tMax));
    if (!(from < to)) return std::nullopt;
    return LightReach{position_, static_cast<float>(from), static_cast<float>(to)};
}

// With h = 1 - cos θ, dω = dφ dh: even up to the inner cone, then falling as t²(3 - 2t), where t runs from 1 there to 0
// at the outer cone. The fall is drawn by its integral, t³ - t⁴/2 = u/2: convex and rising, so that Newton's method
// from above comes down to the root without stepping over it.
Vec3 SpotLight::sampleDirection(const LightOrigin&, Vec2 u) const noexcept {
    const double inner = static_cast<double>(innerOneMinusCos_), ramp = static_cast<double>(outerOneMinusCos_) - inner;
    double h = static_cast<double>(u.x) * (inner + ramp / 2);
    if (h > inner) {
        const double share = 1 - (h - inner) / (ramp / 2); // of the fall, from the outer cone
        double t = std::cbrt(share);
        for (int i = 0; i < 6 && t > 0; ++i) t -= (t * t * t * (1 - t / 2) - share / 2) / (t * t * (3 - 2 * t));
        h = inner + ramp * (1 - std::clamp(t, 0.0, 1.0));
    }
    const double sine = safeSqrt(h * (2 - h)), phi = 2 * kPiD * static_cast<double>(u.y);
    const Frame frame = Frame::fromNormal(axis_);
    return Vec3(normalize(Vec3d(frame.x) * (sine * std::cos(phi)) + Vec3d(frame.y) * (sine * std::sin(phi)) +
                          Vec3d(axis_) * (1 - h)));
}

float SpotLight::pdfDirection(const LightOrigin&, Vec3 w) const noexcept { return falloff(w) * largestPdf(); }

std::unique_ptr<PlacedLight> makeSpotLight(const SpotLightParams& params, const LightContext& context,
                                           Diagnostics& diagnostics) {
    if (!params.stated()) {
        reportMissingAmount(kSpotAmounts, context.span, diagnostics);
        return nullptr;
    }
    const Transform toRender = params.transform.at(context.time).then(context.toRender);
    const Vec3d local = params.lookAt ? *params.lookAt - params.position : params.toward.value_or(Vec3d{0, 0, -1});
    const Vec3d axis = toRender.vector(local);
    const double norm = length(axis);
    if (!(norm > 0 && std::isfinite(norm))) {
        diagnostics.error("E0344", context.span, "the axis of the light has no direction",
                          params.lookAt ? "`look-at` is `position`" : "`toward` is zero");
        return nullptr;
    }
    const double outer = params.angle / 2, inner = params.innerAngle.value_or(0.8 * params.angle) / 2;
    if (inner > outer) {
        Diagnostic& d = diagnostics.error("E0345", context.span, "`inner-angle` is larger than `angle`");
        d.notes.push_back(
            fmt::format("{:.4g} deg inside {:.4g} deg; both are full angles", inner * 360 / kPiD, outer * 360 / kPiD));
        return nullptr;
    }
    const auto intensity = absoluteSpectrum(params, *context.defaultColor,
                                            {.power = SpotLight::solidAngle(inner, outer), .range = kIntensityRange},
                                            context.span, diagnostics);
    if (!intensity) return nullptr;
    return std::make_unique<SpotLight>(Vec3(toRender.point(params.position)), Vec3(axis / norm), inner, outer,
                                       *intensity);
}

} // namespace abbe
