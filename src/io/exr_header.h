// What headers of OpenEXR files hold, in its own types. For the writers of this folder.
#pragma once

#include "io/exr_writer.h"

#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>

namespace abbe {

inline Imath::Box2i toImf(const PixelWindow& w) { return {{w.x0, w.y0}, {w.x1 - 1, w.y1 - 1}}; }

inline void addAttribute(Imf::Header& header, const ImageAttribute& a) {
    const char* name = a.name.c_str();
    if (const auto* text = std::get_if<std::string>(&a.value)) header.insert(name, Imf::StringAttribute(*text));
    if (const auto* number = std::get_if<int>(&a.value)) header.insert(name, Imf::IntAttribute(*number));
    if (const auto* number = std::get_if<double>(&a.value)) header.insert(name, Imf::DoubleAttribute(*number));
}

// `neutral`: without one, their white.
inline void addColours(Imf::Header& header, const Chromaticities& c, std::optional<Chromaticity> neutral) {
    const auto point = [](Chromaticity p) { return Imath::V2f(static_cast<float>(p.x), static_cast<float>(p.y)); };
    Imf::addChromaticities(header, {point(c.red), point(c.green), point(c.blue), point(c.white)});
    Imf::addAdoptedNeutral(header, point(neutral.value_or(c.white)));
}

} // namespace abbe
