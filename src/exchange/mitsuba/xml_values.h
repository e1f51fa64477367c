// Values of attributes: numbers, vectors, transforms.
#pragma once

#include "math/transform.h"

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::exchange {

// Numbers with commas or blanks between them; nothing if something else is there, or a number is not finite.
std::optional<std::vector<double>> xmlNumbers(std::string_view text);

// What a child of <transform> does; it is applied after those before it.
struct XmlStep {
    Transform map;
    std::string fault; // what is wrong with it
};

// `attribute` gives the value of an attribute, empty where there is none.
XmlStep xmlStep(std::string_view tag, const std::function<std::string(const char*)>& attribute);

// "#ff8000" as linear red, green and blue.
std::optional<std::vector<double>> xmlHexColor(std::string_view);

} // namespace abbe::exchange
