// Numbers of KDL 2.0.0, converted exactly (to the nearest double) and independently of any locale.
#pragma once

#include "parser/characters.h"
#include "schema/decimal.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace abbe::parser {

enum class NumberError : std::uint8_t {
    none,
    malformed, // not a number of KDL
    overflow,  // larger than any finite double
};

struct NumberResult {
    double value = 0;
    NumberError error = NumberError::none;
};

// Any number but the keywords (#inf …): sign, decimal with `_`, fraction and exponent, 0x, 0o, 0b. All of `text` must
// belong to it. Values too small for a double become zero, as rounding to nearest demands.
NumberResult parseNumber(std::string_view text);

using schema::convertDecimal;
using schema::scanDecimal;
using schema::skipDecimal;

// What was probably meant by a word that begins like a number and is none: `85mm`, `.5`, `1.`, `0.5f`, `512x512`.
struct NumberRepair {
    const char* code = "E0117";
    std::string message;
    std::string label;           // empty: "write `replacement`"
    std::string replacement;     // empty: nothing can be suggested
    std::string first;           // the number that was meant; not a number when that is unknown
    std::size_t firstLength = 0; // bytes of `written` that make the first number
    std::string second;          // the unit or the second number behind it, or empty
    bool lost = false;
};

NumberRepair repairNumber(std::string_view written);

} // namespace abbe::parser
