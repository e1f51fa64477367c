// Colours as pictures and colour pickers write them: "#c0b0a0", and numbers from 0 to 255.
#pragma once

#include "schema/entry.h"

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace abbe::schema {

// The decoding curve of sRGB.
double decodeSrgb(double encoded);

// Encoded components 0 … 1 of "#rrggbb" or "#rgb".
std::optional<std::array<double, 3>> parseHex(std::string_view);

// Completes the diagnostic at a text that is a colour in hexadecimal digits with the spectrum that it is.
void suggestHex(const Value&, Diagnostic&);

// What the three numbers from value `first` on are, divided by 255 or 100; empty where they cannot be such.
std::string dividedColor(const Entry&, std::size_t first);

} // namespace abbe::schema
