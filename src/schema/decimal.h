// Plain decimal numbers as they stand in a text, converted exactly (to the nearest double) and independently of any
// locale. All texts here end with a NUL.
#pragma once

#include <cstddef>
#include <cstdint>

namespace abbe::schema {

// Powers of ten that a double holds exactly.
inline constexpr double kExactPowers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                          1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

inline bool isDecimalDigit(char c) { return c >= '0' && c <= '9'; }

// Whether a decimal begins at `p`: a digit, or a sign before a digit.
inline bool startsDecimal(const char* p) {
    return isDecimalDigit(*p) || ((*p == '-' || *p == '+') && isDecimalDigit(p[1]));
}

// The slow, always exact conversion of the digits, point and exponent in [p, end); infinite on overflow.
double convertDecimal(const char* p, const char* end);

// Scans a plain decimal number (no `_`) at `p`. Returns its end. Where a double holds mantissa and power of ten
// exactly, one operation rounds correctly [Clinger1990]; all else goes the slow way. Requires: startsDecimal(p).
inline const char* scanDecimal(const char* p, double& value) {
    const bool negative = *p == '-';
    p += negative || *p == '+';
    const char* const first = p;
    std::uint64_t mantissa = 0;
    while (isDecimalDigit(*p)) mantissa = 10 * mantissa + static_cast<unsigned>(*p++ - '0');
    std::ptrdiff_t digits = p - first;
    std::ptrdiff_t exponent = 0;
    if (*p == '.' && isDecimalDigit(p[1])) {
        const char* const fraction = ++p;
        while (isDecimalDigit(*p)) mantissa = 10 * mantissa + static_cast<unsigned>(*p++ - '0');
        exponent = fraction - p;
        digits += p - fraction;
    }
    if ((*p == 'e' || *p == 'E') && (isDecimalDigit(p[1]) || ((p[1] == '-' || p[1] == '+') && isDecimalDigit(p[2])))) {
        ++p;
        const bool down = *p == '-';
        p += down || *p == '+';
        int power = 0;
        for (; isDecimalDigit(*p); ++p) power = power < 100000 ? 10 * power + (*p - '0') : power;
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

// Past the decimal number at `p`, whose value nobody needs yet; null where it may be too large for a double, so that it
// has to be converted to know. Requires: startsDecimal(p).
inline const char* skipDecimal(const char* p) {
    p += *p == '-' || *p == '+';
    const char* const first = p;
    while (isDecimalDigit(*p)) ++p;
    constexpr std::ptrdiff_t kMostDigits = 300; // below the 309 of the largest double
    if (p - first > kMostDigits) return nullptr;
    if (*p == '.' && isDecimalDigit(p[1])) {
        ++p;
        while (isDecimalDigit(*p)) ++p;
    }
    return *p == 'e' || *p == 'E' ? nullptr : p;
}

} // namespace abbe::schema
