#include "exchange/shared/decimal.h"

#include "base/check.h"

#include <array>
#include <cmath>
#include <cstdint>

namespace abbe::exchange {

namespace {

constexpr std::array<double, 20> kTenTo = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,
                                           1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19};

bool isDecimalDigit(char c) { return c >= '0' && c <= '9'; }

} // namespace

// Digits that fit into 53 bits, divided by a power of ten that is exact: one division rounds correctly [Clinger1990].
std::from_chars_result parseDecimal(const char* begin, const char* end, double& value) {
    constexpr std::uint64_t kMostExact = std::uint64_t{1} << 53;
    constexpr std::ptrdiff_t kMostDigits = 18; // that 64 bits hold
    const char* at = begin;
    const bool isNegative = at != end && *at == '-';
    if (isNegative) ++at;
    const char* const first = at;
    std::uint64_t digits = 0;
    for (; at != end && isDecimalDigit(*at); ++at) digits = digits * 10 + static_cast<std::uint64_t>(*at - '0');
    std::ptrdiff_t count = at - first, behind = 0;
    if (at != end && *at == '.') {
        const char* const point = at++;
        for (; at != end && isDecimalDigit(*at); ++at) digits = digits * 10 + static_cast<std::uint64_t>(*at - '0');
        behind = at - point - 1;
        count += behind;
        if (behind == 0) return std::from_chars(begin, end, value);
    }
    const bool goesOn = at != end && (*at == 'e' || *at == 'E');
    if (count == 0 || count > kMostDigits || digits > kMostExact || goesOn) return std::from_chars(begin, end, value);
    const double number = static_cast<double>(digits) / kTenTo[static_cast<std::size_t>(behind)];
    value = isNegative ? -number : number;
    return {at, std::errc()};
}

// A number of at most six digits behind the point is r / 10⁶ of a whole r. As r has less than 16 digits, no other text
// as short gives the same number; from a thousandth to a hundred thousand none with an exponent is shorter.
void appendDecimal(std::string& out, double value) {
    ABBE_CHECK(std::isfinite(value));
    constexpr double kLeast = 1e-3, kMost = 99999;
    std::array<char, 32> text;
    const double size = std::abs(value), whole = std::nearbyint(size * 1e6);
    if (!(size >= kLeast && size <= kMost && whole / 1e6 == size)) {
        const auto result = std::to_chars(text.data(), text.data() + text.size(), value == 0 ? 0.0 : value);
        out.append(text.data(), result.ptr);
        return;
    }
    auto digits = static_cast<std::uint64_t>(whole);
    char* const end = text.data() + text.size();
    char* at = end;
    std::uint64_t fraction = digits % 1000000;
    digits /= 1000000;
    if (fraction != 0) {
        int places = 6;
        for (; fraction % 10 == 0; --places) fraction /= 10;
        for (; places > 0; --places, fraction /= 10) *--at = static_cast<char>('0' + fraction % 10);
        *--at = '.';
    }
    do *--at = static_cast<char>('0' + digits % 10);
    while ((digits /= 10) != 0);
    if (value < 0) *--at = '-';
    out.append(at, static_cast<std::size_t>(end - at));
}

} // namespace abbe::exchange
