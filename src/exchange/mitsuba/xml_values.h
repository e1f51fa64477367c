// Values of attributes: numbers, vectors, transforms.
#pragma once

#include "math/transform.h"

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::exchange {

// Numbers with commas or blanks between them; nothing if something else is there, or a number is not finite.
std::optional<std::vector<double>> xmlNumbers(std::string_view text);
// The same without memory of their own: how many there are; those beyond the end of `into` are counted alone.
std::optional<std::size_t> xmlNumbers(std::string_view text, std::span<double> into);

// What a child of <transform> does; it is applied after those before it.
struct XmlStep {
    Transform map;
    std::string fault; // what is wrong with it
};

// `attribute` gives the value of an attribute, empty where there is none; it stays until the step is done.
XmlStep xmlStep(std::string_view tag, const std::function<std::string_view(const char*)>& attribute);

// "#ff8000" as linear red, green and blue.
std::optional<std::array<double, 3>> xmlHexColor(std::string_view);

} // namespace abbe::exchange
