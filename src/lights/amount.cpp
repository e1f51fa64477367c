#include "lights/amount.h"

#include "spectrum/curve.h"
#include "spectrum/sensor.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>

namespace abbe {

namespace {

bool isLuminous(schema::Dimension d) {
    using enum schema::Dimension;
    return d == luminousFlux || d == luminousIntensity || d == illuminance || d == luminance;
}

// The one quantity that is set, and what turns the curve into it.
struct StatedQuantity {
    schema::Quantity quantity;
    double factor;
};
StatedQuantity statedQuantity(const AmountParams& params, const EmitterFactors& factors) {
    if (params.power) return {*params.power, factors.power};
    if (params.irradiance) return {*params.irradiance, factors.irradiance};
    return {params.luminance ? *params.luminance : *params.intensity, 1};
}

} // namespace

double radiantIntegral(const Curve& curve) {
    // Trapezoids at whole nanometres: exact for tables of that step.
    constexpr int first = static_cast<int>(kMinWavelength), last = static_cast<int>(kMaxWavelength);
    double total = 0.5 * (curve.at(first) + curve.at(last));
    for (int nm = first + 1; nm < last; ++nm) total += curve.at(nm);
    return total;
}

double luminousIntegral(const Curve& curve) { return kLuminousEfficacy * kYIntegral * integrate(curve).y; }

double visibleIntegral(const Curve& curve) { return luminousIntegral(curve) / 683 + 0.05 * radiantIntegral(curve); }

std::optional<double> scaleFor(const schema::Quantity& quantity, const Curve& shape, double factor) {
    const double integral = isLuminous(quantity.dimension) ? luminousIntegral(shape) : radiantIntegral(shape);
    // A spectrum that is almost all invisible could need a scale beyond float.
    const double scale = quantity.value / (factor * integral);
    if (!(integral > 0) || !(scale <= std::numeric_limits<float>::max())) return std::nullopt;
    return scale;
}

Diagnostic& reportBeyondRange(double value, const LightRange& range, std::string_view what, Span span,
                              std::string label, Diagnostics& diagnostics) {
    const char* const how = value > range.most ? "bright" : "dim";
    return diagnostics.error("E0349", span, fmt::format("the {} is too {} to be calculated with", what, how),
                             std::move(label));
}

bool checkLightRange(const ScaledCurve& light, const LightRange& range, Span span, Diagnostics& diagnostics) {
    double most = 0;
    for (int nm = static_cast<int>(kMinWavelength); nm <= static_cast<int>(kMaxWavelength); ++nm)
        most = std::max(most, light.at(static_cast<double>(nm)));
    if (range.holds(most)) return true;
    reportBeyondRange(most, range, "light", span, fmt::format("comes to {:.3g} {}", most, range.unit), diagnostics)
        .notes.push_back(fmt::format("light is 0, or between {:g} and {:g} {}", range.least, range.most, range.unit));
    return false;
}

namespace {

std::optional<ScaledCurve> withinRange(const ScaledCurve& light, const LightRange& range, Span span,
                                       Diagnostics& diagnostics) {
    return checkLightRange(light, range, span, diagnostics) ? std::optional(light) : std::nullopt;
}

} // namespace

std::optional<ScaledCurve> absoluteSpectrum(const AmountParams& params, const Curve& defaultColor,
                                            const EmitterFactors& factors, Span span, Diagnostics& diagnostics) {
    if (params.radiance.curve) {
        const Span place = params.radiance.span.valid() ? params.radiance.span : span;
        if (!params.color) return withinRange({params.radiance.curve, 1}, factors.range, place, diagnostics);
        Diagnostic& d = diagnostics.error("E0341", span, "`color` has no effect beside `radiance`");
        d.notes.push_back("`radiance` is an absolute spectrum; `color` shapes the spectrum of the other amounts");
        return std::nullopt;
    }
    const Curve& color = params.color ? *params.color : defaultColor;
    const auto [quantity, factor] = statedQuantity(params, factors);
    const Span place = quantity.span.valid() ? quantity.span : span;
    if (!(factor > 0 && std::isfinite(factor))) {
        diagnostics.error("E0342", place, "a light without finite area cannot state its power",
                          "state its luminance or radiance");
        return std::nullopt;
    }
    const std::optional<double> scale = scaleFor(quantity, color, factor);
    if (!scale) {
        Diagnostic& d = diagnostics.error("E0343", place, "no amount of this `color` makes that much light");
        d.notes.push_back(isLuminous(quantity.dimension) ? "lm, cd, lx and nits count visible light only"
                                                         : "the spectrum is zero between 360 and 830 nm");
        return std::nullopt;
    }
    return withinRange({&color, *scale}, factors.range, place, diagnostics);
}

void reportMissingAmount(AmountFields allowed, Span span, Diagnostics& diagnostics) {
    constexpr std::pair<AmountField, std::string_view> kExamples[] = {
        {AmountField::power, "`power 800 lm`"},
        {AmountField::luminance, "`luminance 5000 nits`"},
        {AmountField::intensity, "`intensity 120 cd`"},
        {AmountField::irradiance, "`irradiance 100 klx`"},
        {AmountField::radiance, "an absolute `radiance`"}};
    std::string list;
    for (const auto& [field, example] : kExamples)
        if (allowed.has(field)) list += fmt::format("{}{}", list.empty() ? "" : " or ", example);
    Diagnostic& d = diagnostics.error("E0340", span, "the light does not say how much it emits");
    d.notes.push_back("without `exposure` a camera shows 73 000 nits as white, and rooms as black; `exposure auto` "
                      "shows whatever there is");
    d.help = fmt::format("write {}", list);
}

std::vector<double> emittedSpectrum(std::span<const std::unique_ptr<Light>> lights) {
    std::map<const Curve*, double> watts; // many lights share few spectra
    for (const auto& light : lights) watts[light->powerShape()] += light->power();
    // In the order of the lights: that of addresses changes from run to run, and with it the rounding of the sum.
    std::vector<double> total(SampledCurve::kSize);
    const ConstantCurve even(1);
    for (const auto& light : lights) {
        const auto entry = watts.extract(light->powerShape());
        if (!entry || !(entry.mapped() > 0)) continue;
        const Curve& shape = entry.key() ? *entry.key() : even;
        const double integral = radiantIntegral(shape);
        if (!(integral > 0)) continue;
        for (std::size_t i = 0; i < total.size(); ++i)
            total[i] +=
                shape.at(static_cast<double>(kMinWavelength) + static_cast<double>(i)) * (entry.mapped() / integral);
    }
    return total;
}

} // namespace abbe
