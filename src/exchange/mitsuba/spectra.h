// Spectra and colours of Mitsuba's as values of the language.
#pragma once

#include "exchange/mitsuba/context.h"

#include <utility>
#include <vector>

namespace abbe::exchange {

enum class SpectrumUse : std::uint8_t { reflectance, positive, light };

struct MitsubaSpectrum {
    enum class Kind : std::uint8_t { flat, rgb, table, blackbody };
    Kind kind = Kind::flat;
    double value = 0;                            // of flat, and the temperature of a black body
    Vec3d rgb;                                   // linear Rec. 709; of a light 1 1 1 is D65 with Y = 1
    std::vector<std::pair<double, double>> rows; // nm and value, ascending; 0 beyond
};

// What a parameter states: a number, <rgb>, <spectrum>, or a plugin of spectra. Nothing for textures, and after a
// diagnostic.
std::optional<MitsubaSpectrum> readSpectrum(const XmlParam&, SpectrumUse, MitsubaContext&);
bool isTexture(const XmlParam&);

MitsubaSpectrum scaled(MitsubaSpectrum, double factor);
// Appends the value to a property. Reflectances above 1 become 1, with a warning.
void writeSpectrum(SceneNode& property, MitsubaSpectrum, SpectrumUse, Span, MitsubaContext&);
// Y of a light, on the scale on which a flat 1 has 1.
double luminanceOf(const MitsubaSpectrum&);

} // namespace abbe::exchange
