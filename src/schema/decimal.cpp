#include "schema/decimal.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <string_view>
#include <system_error>

namespace abbe::schema {

namespace {

// Whether a decimal that does not fit is too small rather than too large: the power of ten of its first digit other
// than zero decides.
bool isTinyDecimal(std::string_view text) {
    const std::size_t exponentAt = std::min(text.find_first_of("eE"), text.size());
    const std::string_view mantissa = text.substr(0, exponentAt);
    const std::size_t point = std::min(mantissa.find('.'), mantissa.size());
    const std::size_t first = std::min(mantissa.find_first_of("123456789"), mantissa.size());
    std::int64_t power = static_cast<std::int64_t>(point) - static_cast<std::int64_t>(first);
    std::int64_t exponent = 0;
    for (const char c : text.substr(exponentAt))
        if (isDecimalDigit(c) && exponent < 1'000'000'000'000) exponent = 10 * exponent + (c - '0');
    const bool down = exponentAt + 1 < text.size() && text[exponentAt + 1] == '-';
    power += down ? -exponent : exponent;
    return power < 0;
}

} // namespace

double convertDecimal(const char* p, const char* end) {
    double value = 0;
    const auto result = std::from_chars(p, end, value);
    if (result.ec == std::errc::result_out_of_range)
        return isTinyDecimal({p, static_cast<std::size_t>(end - p)}) ? 0 : std::numeric_limits<double>::infinity();
    return value;
}

} // namespace abbe::schema
