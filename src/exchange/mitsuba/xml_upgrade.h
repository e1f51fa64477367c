// Spellings of older versions of Mitsuba: what was written for 0.5 and 2 means the same in 3.
#pragma once

#include "exchange/mitsuba/xml_object.h"

#include <optional>
#include <string_view>
#include <vector>

namespace abbe::exchange {

struct XmlVersion {
    int major = 3, minor = 0;
};

// "0.5.0"; the other one where the text is none.
XmlVersion xmlVersion(std::string_view text, XmlVersion otherwise);

// Before version 2 names were in camel case, and textures had uoffset, voffset, uscale and vscale.
void upgradeXmlObject(XmlObject&, XmlVersion);

// "#ff8000" as linear red, green and blue.
std::optional<std::vector<double>> xmlHexColor(std::string_view);

} // namespace abbe::exchange
