// The fields of AmountParams, for the table of a type derived from it.
#pragma once

#include "lights/amount.h"

#include <vector>

namespace abbe {

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

} // namespace abbe
