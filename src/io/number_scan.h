// Numbers out of text, for the mesh readers: exact, fast, independent of the locale.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <type_traits>

namespace abbe {

// The whole numbers of meshes are short: no digit of these can overflow, which the library's loop looks for at each.
// Moves `p` only if there is such a number.
template <typename T> std::optional<T> scanShortInteger(const char*& p, const char* end) {
    constexpr int kMostDigits = 18;
    const char* at = p;
    const bool negative = std::is_signed_v<T> && at < end && *at == '-';
    if (negative) ++at;
    const char* const first = at;
    std::int64_t value = 0;
    for (; at < end && *at >= '0' && *at <= '9'; ++at) {
        if (at - first == kMostDigits) return std::nullopt;
        value = 10 * value + (*at - '0');
    }
    if (at == first) return std::nullopt;
    p = at;
    return static_cast<T>(negative ? -value : value);
}

// Reads a number at `p` and moves `p` behind it; nothing if there is none or it is too large for T. A leading + is
// accepted, a number too small for T is 0.
template <typename T> std::optional<T> scanNumber(const char*& p, const char* end) {
    const char* start = p < end && *p == '+' ? p + 1 : p;
    T value{};
    if constexpr (std::is_integral_v<T>) {
        static_assert(sizeof(T) == 8);
        if (const auto whole = scanShortInteger<T>(start, end)) return p = start, whole;
    }
    const auto [rest, error] = std::from_chars(start, end, value);
    if (error == std::errc::result_out_of_range) {
        const auto isExponent = [](char c) { return c == 'e' || c == 'E'; };
        const char* exponent = std::find_if(start, rest, isExponent);
        if (exponent == rest || exponent + 1 == rest || exponent[1] != '-') return std::nullopt;
        value = T(0);
    } else if (error != std::errc()) {
        return std::nullopt;
    }
    p = rest;
    return value;
}

} // namespace abbe
