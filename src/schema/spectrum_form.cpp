#include "schema/spectrum_reader.h"

#include <algorithm>
#include <array>

namespace abbe::schema {

namespace {

using Form = SpectrumValue::Form;

constexpr auto kForms = std::to_array<SpectrumForm>({
    {"rgb", Form::rgb, "rgb 0.8 0.2 0.1", "Linear red, green and blue in the header's space, or in `space=`."},
    {"srgb", Form::rgb, "srgb \"#d87040\"", "Encoded sRGB: `\"#rrggbb\"` or three numbers from 0 to 1."},
    {"table", Form::table, "table 400 0.1 500 0.2 700 0.8",
     "Pairs of wavelength in nm and value, or the name of a file of such lines."},
    {"blackbody", Form::blackbody, "blackbody 3200 K", "Thermal radiation of a temperature."},
    {"illuminant", Form::illuminant, "illuminant D65", "A standard illuminant of the CIE."},
    {"line", Form::line, "line 589.3 nm", "One wavelength."},
    {"measured", Form::measured, "measured cornell-white", "A measured spectrum that comes with the program."},
    {"glass", Form::glass, "glass BK7", "The refractive index of an optical glass or another transparent substance."},
    {"metal", Form::metal, "metal Au", "The complex refractive index of a metal."},
    {"sellmeier", Form::sellmeier, "sellmeier 1.03961 0.00600 0.23179 0.02002 1.01047 103.561",
     "Sellmeier's formula: B1 C1 B2 C2 B3 C3, C in µm²."},
    {"cauchy", Form::cauchy, "cauchy 1.5046 0.0042",
     "Cauchy's formula A + B/λ² + C/λ⁴ + D/λ⁶, λ in µm; two to four numbers."},
});

} // namespace

std::span<const SpectrumForm> spectrumForms() { return kForms; }

const SpectrumForm* findSpectrumForm(std::string_view name) {
    const auto found = std::ranges::find(kForms, name, &SpectrumForm::name);
    return found == kForms.end() ? nullptr : &*found;
}

bool fits(Form form, SpectrumRole role) {
    switch (form) {
    case Form::flat:
    case Form::table:
        return true;
    case Form::rgb:
    case Form::measured:
        return role != SpectrumRole::index;
    case Form::blackbody:
    case Form::illuminant:
    case Form::line:
        return role == SpectrumRole::emission || role == SpectrumRole::shape || role == SpectrumRole::tint;
    case Form::glass:
    case Form::metal:
    case Form::sellmeier:
    case Form::cauchy:
        return role == SpectrumRole::index;
    }
    return false;
}

} // namespace abbe::schema
