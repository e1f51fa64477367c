// How much a light emits: one stated quantity and the shape of its spectrum, turned into absolute spectral radiance.
// Luminous quantities use 683 lm/W and the CIE 1931 observer, radiant ones the integral over [360, 830] nm.
#pragma once

#include "base/diagnostic.h"
#include "base/flags.h"
#include "render/light.h"
#include "schema/type.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace abbe {

// The amount as a scene states it. At most one of the first five is set (the schema's group "amount").
struct AmountParams {
    std::optional<schema::Quantity> power;      // W or lm
    schema::TexturedSpectrum radiance = {};     // W·m⁻²·sr⁻¹·nm⁻¹; textures for area lights alone
    std::optional<schema::Quantity> luminance;  // cd/m²
    std::optional<schema::Quantity> intensity;  // cd
    std::optional<schema::Quantity> irradiance; // lx or W/m²
    const Curve* color = nullptr;               // any scale; null: the default of LightContext

    bool hasRadiance() const { return radiance.curve || radiance.texture; }
    bool stated() const { return power || hasRadiance() || luminance || intensity || irradiance; }
};

// The quantities that make sense for a type of light.
enum class AmountField : std::uint8_t { power = 1, radiance = 2, luminance = 4, intensity = 8, irradiance = 16 };
using AmountFields = Flags<AmountField>;

// Those of lights with an area.
inline constexpr AmountFields kAreaAmounts =
    AmountFields(AmountField::power) | AmountField::radiance | AmountField::luminance;

// A curve times a number.
struct ScaledCurve {
    const Curve* curve = nullptr; // not owned
    double scale = 0;

    Spectrum at(const Wavelengths& w) const noexcept { return curve->at(w) * static_cast<float>(scale); }
    double at(double nanometres) const { return curve->at(nanometres) * scale; }
};

// ∫ s(λ) dλ over [360, 830] nm.
double radiantIntegral(const Curve&);
// 683 lm/W ∫ s(λ) ȳ(λ) dλ.
double luminousIntegral(const Curve&);

// What lights are chosen by (Light::visiblePower): ∫ s(λ) (ȳ(λ) + 1/20) dλ.
double visibleIntegral(const Curve&);

// The k for which `factor` times the integral of k s(λ) — radiant or luminous, as the quantity's dimension says — is
// the quantity. Nothing if the spectrum has no such light.
// Requires: factor > 0.
std::optional<double> scaleFor(const schema::Quantity&, const Curve& shape, double factor);

// What there may be of light at any wavelength, if there is any. Sums of pixels resolve 2e-22 and hold samples up to
// 4e12 (math/exact_sum.h), and nothing is seen brighter than what emits: so much for what fills the view. What is
// small may be brighter, as it is hardly ever hit but lights other things; there single precision sets the bounds.
struct LightRange {
    double least, most;
    std::string_view unit;
    bool holds(double value) const { return value == 0 || (value >= least && value <= most); }
};
inline constexpr LightRange kSkyRadiance = {1e-18, 1e12, "W/m²/sr/nm"};
inline constexpr LightRange kSurfaceRadiance = {1e-18, 1e30, "W/m²/sr/nm"};
inline constexpr LightRange kIntensityRange = {1e-30, 1e30, "W/sr/nm"};
inline constexpr LightRange kIrradianceRange = {1e-30, 1e30, "W/m²/nm"};

// An error about what the range does not hold; `what` is it of.
Diagnostic& reportBeyondRange(double value, const LightRange&, std::string_view what, Span, std::string label,
                              Diagnostics&);
// False, after an error, if the largest value between 360 and 830 nm is neither 0 nor in the range.
bool checkLightRange(const ScaledCurve&, const LightRange&, Span, Diagnostics&);

// What the geometry of a light makes of its radiance (point and spot: of its intensity on the axis).
struct EmitterFactors {
    double power = 0;                    // flux over radiance, m²·sr, or over intensity, sr
    double irradiance = 0;               // sr
    LightRange range = kSurfaceRadiance; // of the spectrum that is asked for
};

// The absolute spectrum of a light: radiance, or intensity for lights without extent. Says what is missing, set twice
// over or without effect; nothing after an error. Requires: params.stated().
std::optional<ScaledCurve> absoluteSpectrum(const AmountParams&, const Curve& defaultColor, const EmitterFactors&, Span,
                                            Diagnostics&);

// The error of a light that states no amount.
void reportMissingAmount(AmountFields, Span, Diagnostics&);

// The fields of AmountParams, for the table of a type derived from it.
template <typename Params> void addAmountFields(std::vector<schema::FieldInfo>& fields, AmountFields allowed) {
    using schema::Dimension;
    using schema::FieldType;
    using OptionalQuantity = std::optional<schema::Quantity>;
    constexpr double kMost = std::numeric_limits<double>::infinity();
    const auto quantity = [](std::string_view name, OptionalQuantity Params::*member) {
        return schema::field<Params, OptionalQuantity>(FieldType::quantity, name, member)
            .group("amount")
            .range(0, kMost);
    };
    if (allowed.has(AmountField::power))
        fields.push_back(quantity("power", &Params::power)
                             .unit({Dimension::power, Dimension::luminousFlux})
                             .doc("Light emitted in all directions together, in W (radiant) or lm (luminous).")
                             .example("power 800 lm")
                             .synonyms({"watts", "flux", "lumens"}));
    if (allowed.has(AmountField::radiance)) {
        fields.push_back(
            schema::field<Params, schema::TexturedSpectrum>(FieldType::spectrum, "radiance", &Params::radiance)
                .group("amount")
                .role(schema::SpectrumRole::emission)
                .doc("Absolute spectral radiance in W per m², sr and nm.")
                .example("radiance table 400 0 500 8 600 15.6 700 18.4")
                .synonyms({"emission", "L", "emit"}));
        fields.back().texturable = false; // but for area lights
    }
    if (allowed.has(AmountField::luminance))
        fields.push_back(quantity("luminance", &Params::luminance)
                             .unit({Dimension::luminance})
                             .doc("Luminance in cd/m² (nits).")
                             .example("luminance 5000 nits")
                             .synonyms({"brightness", "nits"}));
    if (allowed.has(AmountField::intensity))
        fields.push_back(quantity("intensity", &Params::intensity)
                             .unit({Dimension::luminousIntensity})
                             .doc("Luminous intensity in cd; for a spot, on its axis.")
                             .example("intensity 120 cd")
                             .synonyms({"I", "candela", "strength"}));
    if (allowed.has(AmountField::irradiance))
        fields.push_back(quantity("irradiance", &Params::irradiance)
                             .unit({Dimension::illuminance, Dimension::irradiance})
                             .doc("Light arriving on a surface that faces the light, in lx or W/m².")
                             .example("irradiance 100 klx")
                             .synonyms({"illuminance", "lux"}));
    fields.push_back(schema::field<Params, const Curve*>(FieldType::spectrum, "color", &Params::color)
                         .role(schema::SpectrumRole::shape)
                         .doc("Shape of the emitted spectrum; its scale has no effect. Without it: illuminant D65.")
                         .example("color blackbody 3200 K")
                         .synonyms({"colour", "spectrum", "temperature"}));
}

// What all lights of a scene emit together. Spectral power in W/nm at each whole nanometre from 360 to 830. Lights that
// do not tell their spectrum count as even. Requires: committed lights.
std::vector<double> emittedSpectrum(std::span<const std::unique_ptr<Light>>);

} // namespace abbe
