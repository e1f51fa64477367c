// Numbers out of text, for the mesh readers: exact, fast, independent of the locale.
#pragma once

#include <algorithm>
#include <charconv>
#include <optional>

namespace abbe {

// Reads a number at `p` and moves `p` behind it; nothing if there is none or it is too large for T. A leading + is
// accepted, a number too small for T is 0.
template <typename T> std::optional<T> scanNumber(const char*& p, const char* end) {
    const char* start = p < end && *p == '+' ? p + 1 : p;
    T value{};
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
