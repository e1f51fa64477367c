#include "lights/point_light.h"

#include "lights/amount.h"

namespace abbe {

namespace {
constexpr AmountFields kPointAmounts = AmountFields(AmountField::power) | AmountField::intensity;
}

schema::TypeInfo pointLightType() {
    schema::TypeInfo type{.kind = schema::Kind::light,
                          .name = "point",
                          .doc = "A point that emits equally in all directions.",
                          .example = "light point { position 0 2 0; power 800 lm }",
                          .fields = {}};
    type.fields.push_back(schema::field(schema::FieldType::vector3, "position", &PointLightParams::position)
                              .unit({schema::Dimension::length})
                              .byDefault("0 0 0")
                              .doc("Where the light is.")
                              .example("position 0 2.4 0")
                              .synonyms({"from", "center", "location"}));
    addAmountFields<PointLightParams>(type.fields, kPointAmounts);
    type.fields.push_back(schema::field(schema::FieldType::transform, "transform", &PointLightParams::transform)
                              .doc("Moves the light: steps from top to bottom, as applied to it.")
                              .example("transform { translate 0 2 0 }")
                              .synonyms({"to-world", "matrix"}));
    return type;
}

PointLight::PointLight(Vec3 position, ScaledCurve intensity)
    : position_(position), intensity_(intensity),
      power_(4 * kPiD * radiantIntegral(*intensity.curve) * intensity.scale),
      visiblePower_(4 * kPiD * visibleIntegral(*intensity.curve) * intensity.scale) {}

std::optional<LightSample> PointLight::sample(const Receiver& from, std::uint32_t, Vec2, const Wavelengths& lambda,
                                              float) const noexcept {
    const Vec3 offset = position_ - from.p;
    const float d2 = lengthSquared(offset);
    if (!(d2 >= std::numeric_limits<float>::min())) return std::nullopt; // at the light: no direction
    const float distance = std::sqrt(d2);
    const Vec3 wi = offset / distance;
    return std::optional<LightSample>(std::in_place, wi, position_, distance, intensity_.at(lambda) * (1 / d2), 1.f,
                                      true);
}

std::unique_ptr<PlacedLight> makePointLight(const PointLightParams& params, const LightContext& context,
                                            Diagnostics& diagnostics) {
    if (!params.stated()) {
        reportMissingAmount(kPointAmounts, context.span, diagnostics);
        return nullptr;
    }
    const auto intensity = absoluteSpectrum(params, *context.defaultColor,
                                            {.power = 4 * kPiD, .range = kIntensityRange}, context.span, diagnostics);
    if (!intensity) return nullptr;
    const Vec3d position = params.transform.at(context.time).then(context.toRender).point(params.position);
    return std::make_unique<PointLight>(Vec3(position), *intensity);
}

} // namespace abbe
