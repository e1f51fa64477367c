// What was probably meant by a word that begins like a number and is none: `85mm`, `.5`, `1.`, `0.5f`, `512x512`.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace abbe::parser {

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
