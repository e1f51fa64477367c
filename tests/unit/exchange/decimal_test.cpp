// Decimal numbers as texts: the bits and the characters of the standard library.
#include "exchange/shared/decimal.h"

#include <cmath>
#include <cstring>
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <random>
#include <string>
#include <string_view>

using namespace abbe::exchange;

namespace {

// What the standard library makes of it: where it ends, whether it fails, and the bits.
bool readsAsStandard(std::string_view text) {
    double ours = 7, theirs = 7;
    const auto a = parseDecimal(text.data(), text.data() + text.size(), ours);
    const auto b = std::from_chars(text.data(), text.data() + text.size(), theirs);
    return a.ptr == b.ptr && a.ec == b.ec && std::memcmp(&ours, &theirs, sizeof ours) == 0;
}

bool writesAsStandard(double value) {
    char text[40];
    const auto result = std::to_chars(text, text + sizeof text, value == 0 ? 0.0 : value);
    std::string ours = "x";
    appendDecimal(ours, value);
    return ours == "x" + std::string(text, result.ptr);
}

} // namespace

TEST_CASE("decimal numbers are read as the standard library reads them") {
    for (const char* text : {"0",
                             "-0",
                             "1",
                             "-1.5",
                             ".5",
                             "-.5",
                             "5.",
                             ".",
                             "-",
                             "",
                             "+1",
                             "1e5",
                             "1.5e",
                             "1e+",
                             "1E-3",
                             "0x10",
                             "inf",
                             "nan",
                             "-inf",
                             "1..2",
                             "1.2.3",
                             "1 2",
                             "00012",
                             "0.000",
                             "1-2",
                             "--1",
                             "1e400",
                             "1e-400",
                             "0.1",
                             "0.3",
                             "123456789012345678",
                             "9007199254740992",
                             "9007199254740993",
                             "9007199254740993.0",
                             "0.000000000000000001",
                             "1234567890123456789",
                             "12345678901234567890",
                             "99999999999999999999999999",
                             "0.1234567890123456789",
                             "179769313486231580793728971405301e276"})
        CHECK_MESSAGE(readsAsStandard(text), text);
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> exponent(-9, 9), unit(-1, 1);
    int wrong = 0;
    for (int i = 0; i < 300'000; ++i) {
        const double value = unit(random) * std::pow(10, exponent(random));
        wrong += !readsAsStandard(fmt::format("{:.{}f}", value, i % 20)) + !readsAsStandard(fmt::format("{}", value));
    }
    CHECK(wrong == 0);
}

TEST_CASE("decimal numbers are written as the standard library writes them") {
    for (const double value :
         {0.0, -0.0,      1.0,  -1.0,         0.001,   0.000999999, 0.001000001, 99999.0, 99999.000001, 100000.0, 0.1,
          0.2, 0.1 + 0.2, 1e-6, 12345.678901, 1.0 / 3, 1e22,        1e300,       5e-324,  10.5,         -20.0})
        CHECK_MESSAGE(writesAsStandard(value), value);
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> exponent(-5, 7), unit(-1, 1);
    int wrong = 0;
    for (int i = 0; i < 300'000; ++i) {
        const double value = unit(random) * std::pow(10, exponent(random)), power = std::pow(10, i % 9);
        wrong += !writesAsStandard(value) + !writesAsStandard(std::round(value * power) / power) +
                 !writesAsStandard(static_cast<double>(static_cast<float>(value)));
    }
    CHECK(wrong == 0);
}
