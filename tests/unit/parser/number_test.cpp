// Conversion of numbers: exact to the last bit, whatever the spelling.
#include "parser/number.h"

#include <bit>
#include <clocale>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <limits>
#include <random>
#include <string>

using abbe::parser::NumberError;
using abbe::parser::parseNumber;
using abbe::parser::scanDecimal;

namespace {

bool sameBits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

double scanned(const std::string& text) {
    double value = std::nan("");
    const char* const end = scanDecimal(text.c_str(), value);
    if (end != text.c_str() + text.size()) FAIL_CHECK(text);
    return value;
}

// Both ways of the parser against the C library, which rounds correctly too.
void checkExact(const std::string& text) {
    const double expected = std::strtod(text.c_str(), nullptr);
    if (!sameBits(scanned(text), expected) || !sameBits(parseNumber(text).value, expected)) FAIL_CHECK(text);
}

double parsed(std::string_view text) {
    const auto result = parseNumber(text);
    CHECK_MESSAGE(result.error == NumberError::none, std::string(text));
    return result.value;
}

} // namespace

TEST_CASE("random doubles survive 17 digits exactly") {
    std::mt19937_64 random(7);
    for (int i = 0; i < 200'000; ++i) {
        const double value = std::bit_cast<double>(random());
        if (!std::isfinite(value)) continue;
        checkExact(fmt::format("{:.17g}", value));
        checkExact(fmt::format("{}", value));
    }
}

TEST_CASE("short decimals, where the fast path ends") {
    std::mt19937_64 random(8);
    for (int i = 0; i < 200'000; ++i) {
        const std::uint64_t mantissa = random() >> (random() % 64);
        const int exponent = static_cast<int>(random() % 60) - 30;
        checkExact(fmt::format("{}e{}", mantissa, exponent));
        const std::uint64_t fraction = random() % 1'000'000;
        checkExact(fmt::format("{}.{:06}", mantissa % 100'000, fraction));
    }
    for (const char* text : {"9007199254740992e22", "9007199254740993e22", "9007199254740993", "1e22", "1e23", "0.1",
                             "1e-22", "123456789012345678901234567890", "0.000000000000000000000000000001", "-0",
                             "+0.5", "-0.0", "2.2250738585072011e-308", "4.9e-324", "1.7976931348623157e308",
                             "179769313486231570000e289", "00000000000000000000000001.5", "9007199254740992.5"})
        checkExact(text);
}

TEST_CASE("rounding cases halfway between two doubles") {
    std::mt19937_64 random(9);
    for (int i = 0; i < 20'000; ++i) {
        const std::uint64_t odd = (std::uint64_t{1} << 53 | (random() >> 11)) * 2 + 1; // needs 54 bits or more
        checkExact(fmt::format("{}", odd));
        checkExact(fmt::format("{}.0000000000000000000000000000000000001", odd));
    }
}

TEST_CASE("too large and too small") {
    for (const char* text : {"1e309", "-1e400", "1.8e308", "1e99999999999", "179769313486231590000e289"})
        CHECK_MESSAGE(parseNumber(text).error == NumberError::overflow, text);
    CHECK(parseNumber(std::string(400, '9')).error == NumberError::overflow);
    for (const char* text : {"1e-400", "-1e-400", "1e-99999999999", "0.0e999999"}) checkExact(text);
    checkExact("0." + std::string(400, '0') + "1");
    checkExact("0." + std::string(400, '0') + "1e5");
    checkExact("0." + std::string(400, '0') + "1e405");
    checkExact(std::string(400, '9') + "e-390");
    CHECK(std::signbit(parsed("-1e-400")));
}

TEST_CASE("underscores and other bases") {
    CHECK(parsed("1_000_000.000_1e+1_0") == 1000000.0001e10);
    CHECK(parsed("1__") == 1);
    CHECK(parsed("0xff") == 255);
    CHECK(parsed("-0xDEAD_beef") == -3735928559.0);
    CHECK(parsed("+0o17") == 15);
    CHECK(parsed("0b1010_1") == 21);
    CHECK(parsed("0xFFFFFFFFFFFFFFFF") == 18446744073709551615.0);
    CHECK(parsed("0x20000000000001") == 9007199254740992.0); // a tie goes to even
    CHECK(parsed("0x20000000000003") == 9007199254740996.0);
    CHECK(parsed("0x200000000000010000000001") == std::ldexp(9007199254740994.0, 40)); // above the tie
    CHECK(parsed("0b1" + std::string(100, '0')) == std::ldexp(1.0, 100));
    CHECK(parsed("0o1" + std::string(100, '0')) == std::ldexp(1.0, 300));
    CHECK(parseNumber("0x1" + std::string(300, '0')).error == NumberError::overflow);
}

TEST_CASE("what is no number") {
    for (const char* text : {"",     "+",   "-",   "1.",  ".5", "1.e5", "1e",    "1e+",   "_1",  "1._5", "0x",
                             "0x_1", "0o8", "0b2", "0xg", "1f", "1..2", "1.2.3", "1e5.5", "--1", "1-2",  "0X1F"})
        CHECK_MESSAGE(parseNumber(text).error == NumberError::malformed, text);
}

TEST_CASE("the locale does not matter") {
    const std::string before = std::setlocale(LC_ALL, nullptr);
    // Whichever of them the machine has; the C locale proves nothing, but does no harm.
    for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "nb_NO.UTF-8"})
        if (std::setlocale(LC_ALL, name) != nullptr) break;
    CHECK(scanned("0.5") == 0.5);
    CHECK(scanned("1234.5678901234567890123") == 1234.5678901234567890123);
    std::setlocale(LC_ALL, before.c_str());
}
