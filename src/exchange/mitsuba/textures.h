// Textures of Mitsuba's, and parameters that may be textures.
#pragma once

#include "exchange/mitsuba/spectra.h"

#include <functional>

namespace abbe::exchange {

// Texture coordinates: Mitsuba's images have v = 0 at their top row, ours at the bottom one. Imported shapes have v' =
// 1 − v; `to_uv` of textures is applied to the shapes' coordinates before that.

// Writes `property VALUE` for a parameter that is a colour or a texture of colours; the default, where there is one,
// for a parameter that is not there.
void writeColor(SceneNode& parent, std::string property, const XmlObject&, std::string_view param, SpectrumUse,
                std::optional<double> otherwise, MaterialTraits&, MitsubaContext&);

// The same for a parameter that is a number or a texture of numbers. `map` turns Mitsuba's number into ours; textures
// go through it at a few stops where it is given.
using NumberMap = std::function<double(double)>;
void writeNumber(SceneNode& parent, std::string property, const XmlObject&, std::string_view param,
                 std::optional<double> otherwise, const NumberMap& map, MaterialTraits&, MitsubaContext&);

// Appends a texture, by its name or in place. `data`: it stands for numbers, not for colours.
void writeTexture(SceneNode& at, const XmlObject&, bool data, MaterialTraits&, MitsubaContext&);

} // namespace abbe::exchange
