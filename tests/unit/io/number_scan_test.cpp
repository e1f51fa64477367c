// Whole numbers out of text have a way of their own while they are short: it must agree with the library's.
#include "io/number_scan.h"
#include "support/statistics.h"

#include <doctest/doctest.h>
#include <string>

namespace abbe {
namespace {

template <typename T> std::optional<T> byLibrary(const char*& p, const char* end) {
    const char* start = p < end && *p == '+' ? p + 1 : p;
    T value{};
    const auto [rest, error] = std::from_chars(start, end, value);
    if (error != std::errc()) return std::nullopt;
    p = rest;
    return value;
}

template <typename T> bool agrees(const std::string& text) {
    const char *ours = text.data(), *theirs = ours, *end = ours + text.size();
    return scanNumber<T>(ours, end) == byLibrary<T>(theirs, end) && ours == theirs;
}

TEST_CASE("whole numbers of any length and sign are read as by std::from_chars") {
    for (const char* text :
         {"", "+", "-", "+-5", "--5", "0", "-0", "007", "999999999999999999", "1000000000000000000",
          "9223372036854775807", "9223372036854775808", "-9223372036854775808", "18446744073709551615",
          "18446744073709551616", "123456789012345678901234567890", "12/3", "7 8"}) {
        CAPTURE(text);
        CHECK(agrees<std::int64_t>(text));
        CHECK(agrees<std::uint64_t>(text));
    }
    test::Random random(1);
    int disagreed = 0;
    for (int i = 0; i < 20000; ++i) {
        std::string text;
        for (std::uint32_t n = random.bits() % 24; n > 0; --n)
            text += "0123456789+-/ "[random.bits() % 14 % (1 + i % 14)];
        disagreed += !agrees<std::int64_t>(text) || !agrees<std::uint64_t>(text);
    }
    CHECK(disagreed == 0);
}

} // namespace
} // namespace abbe
