// Numbers of KDL 2.0.0, converted exactly (to the nearest double) and independently of any locale.
#pragma once

#include "parser/characters.h"

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

// Powers of ten that a double holds exactly.
inline constexpr double kExactPowers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                          1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

// The slow, always exact conversion of the digits, point and exponent in [p, end); infinite on overflow.
double convertDecimal(const char* p, const char* end);

// Scans a plain decimal number (no `_`) at `p`, which holds a digit or a sign before a digit, in a text that ends with
// a NUL. Returns its end. Where a double holds mantissa and power of ten exactly, one operation rounds correctly
// [Clinger1990]; all else goes the slow way.
inline const char* scanDecimal(const char* p, double& value) {
    const bool negative = *p == '-';
    p += negative || *p == '+';
    const char* const first = p;
    std::uint64_t mantissa = 0;
    while (isDigit(*p)) mantissa = 10 * mantissa + static_cast<unsigned>(*p++ - '0');
    std::ptrdiff_t digits = p - first;
    std::ptrdiff_t exponent = 0;
    if (*p == '.' && isDigit(p[1])) {
        const char* const fraction = ++p;
        while (isDigit(*p)) mantissa = 10 * mantissa + static_cast<unsigned>(*p++ - '0');
        exponent = fraction - p;
        digits += p - fraction;
    }
    if ((*p == 'e' || *p == 'E') && (isDigit(p[1]) || ((p[1] == '-' || p[1] == '+') && isDigit(p[2])))) {
        ++p;
        const bool down = *p == '-';
        p += down || *p == '+';
        int power = 0;
        for (; isDigit(*p); ++p) power = power < 100000 ? 10 * power + (*p - '0') : power;
        exponent += down ? -power : power;
    }
    constexpr std::uint64_t exactLimit = std::uint64_t{1} << 53;
    double magnitude;
    if (digits <= 19 && mantissa <= exactLimit && exponent >= -22 && exponent <= 22)
        magnitude = exponent < 0 ? static_cast<double>(mantissa) / kExactPowers[-exponent]
                                 : static_cast<double>(mantissa) * kExactPowers[exponent];
    else
        magnitude = convertDecimal(first, p);
    value = negative ? -magnitude : magnitude;
    return p;
}

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
