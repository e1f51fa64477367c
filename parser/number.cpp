#include "parser/number.h"

#include "parser/characters.h"
#include "schema/unit.h"

#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <string>

namespace abbe::parser {

namespace {

int digitValue(char c) {
    if (isDigit(c)) return c - '0';
    const char lower = static_cast<char>(c | 0x20);
    return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : 16;
}

// An integer in base 2^bits, rounded once: its bits are regrouped into hexadecimal digits, which from_chars converts.
NumberResult parseBased(std::string_view digits, int bits) {
    if (digits.empty() || digitValue(digits[0]) >= 1 << bits) return {0, NumberError::malformed};
    std::string binary;
    for (const char c : digits) {
        if (c == '_') continue;
        const int digit = digitValue(c);
        if (digit >= 1 << bits) return {0, NumberError::malformed};
        for (int i = bits - 1; i >= 0; --i) binary.push_back(digit >> i & 1 ? '1' : '0');
    }
    binary.insert(0, (4 - binary.size() % 4) % 4, '0');
    std::string hex;
    for (std::size_t i = 0; i < binary.size(); i += 4) {
        int digit = 0;
        for (std::size_t k = i; k < i + 4; ++k) digit = 2 * digit + (binary[k] - '0');
        hex.push_back("0123456789abcdef"[digit]);
    }
    double value = 0;
    const auto result = std::from_chars(hex.data(), hex.data() + hex.size(), value, std::chars_format::hex);
    if (result.ec != std::errc{}) return {0, NumberError::overflow};
    return {value, NumberError::none};
}

// integer ['.' integer] [('e'|'E') [sign] integer], where integer = digit {digit | '_'}
bool isDecimalForm(std::string_view text) {
    std::size_t i = 0;
    const auto integer = [&] {
        const bool starts = i < text.size() && isDigit(text[i]);
        while (i < text.size() && starts && (isDigit(text[i]) || text[i] == '_')) ++i;
        return starts;
    };
    if (!integer()) return false;
    if (i < text.size() && text[i] == '.') {
        ++i;
        if (!integer()) return false;
    }
    if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
        ++i;
        if (i < text.size() && (text[i] == '-' || text[i] == '+')) ++i;
        if (!integer()) return false;
    }
    return i == text.size();
}

} // namespace

NumberResult parseNumber(std::string_view text) {
    const bool negative = text.starts_with('-');
    if (negative || text.starts_with('+')) text.remove_prefix(1);
    NumberResult result;
    if (text.starts_with("0x") || text.starts_with("0o") || text.starts_with("0b")) {
        const int bits = text[1] == 'x' ? 4 : text[1] == 'o' ? 3 : 1;
        result = parseBased(text.substr(2), bits);
    } else if (isDecimalForm(text)) {
        std::string digits(text);
        std::erase(digits, '_');
        result.value = convertDecimal(digits.data(), digits.data() + digits.size());
        if (std::isinf(result.value)) result.error = NumberError::overflow;
    } else {
        result.error = NumberError::malformed;
    }
    if (negative) result.value = -result.value;
    return result;
}

namespace {

// The leading part of a word that can be read as a number if missing digits around the point are zeros.
struct LooseNumber {
    std::string canonical; // "-0.5" for "-.5", "1.0" for "1."
    std::size_t length = 0;
};

LooseNumber readLoosely(std::string_view text) {
    std::size_t i = 0;
    const auto run = [&] {
        const std::size_t first = i;
        while (i < text.size() && (isDigit(text[i]) || (text[i] == '_' && i > first))) ++i;
        return std::string(text.substr(first, i - first));
    };
    LooseNumber number;
    if (text[0] == '-' || text[0] == '+') number.canonical = text[i++];
    const std::string whole = run();
    number.canonical += whole.empty() ? "0" : whole;
    if (i < text.size() && text[i] == '.') {
        ++i;
        const std::string fraction = run();
        number.canonical += "." + (fraction.empty() ? "0" : fraction);
    }
    number.length = i;
    const std::size_t sign = i + 1 < text.size() && (text[i + 1] == '-' || text[i + 1] == '+') ? 1 : 0;
    if (i + 1 + sign < text.size() && (text[i] == 'e' || text[i] == 'E') && isDigit(text[i + 1 + sign])) {
        i += 1 + sign;
        run();
        number.canonical += text.substr(number.length, i - number.length);
        number.length = i;
    }
    return number;
}

bool isDigits(std::string_view text) {
    for (const char c : text)
        if (!isDigit(c)) return false;
    return !text.empty();
}

} // namespace

NumberRepair repairNumber(std::string_view written) {
    const LooseNumber loose = readLoosely(written);
    const std::string_view rest = written.substr(loose.length);
    NumberRepair repair;
    repair.first = loose.canonical;
    repair.firstLength = loose.length;
    if (rest.empty()) {
        repair.code = "E0106";
        repair.message = "a number needs digits on both sides of its point";
        repair.replacement = loose.canonical;
    } else if (const std::string_view unit = rest == "\xc2\xb0" ? "deg" : rest; schema::findUnit(unit)) {
        repair.code = "E0105";
        repair.message = "a number and its unit are two words";
        repair.second = unit;
        repair.replacement = fmt::format("{} {}", loose.canonical, unit);
    } else if (rest == "f" || rest == "F") {
        repair.message = fmt::format("`{}` is not a number", written);
        repair.replacement = loose.canonical;
    } else if ((rest[0] == 'x' || rest[0] == 'X') && isDigits(rest.substr(1)) && loose.canonical != "0") {
        repair.message = "two numbers are two words";
        repair.second = rest.substr(1);
        repair.replacement = fmt::format("{} {}", loose.canonical, repair.second);
    } else {
        repair.message = fmt::format("`{}` is not a number", written);
        const bool expression = std::string_view("*+-^").find(rest[0]) != std::string_view::npos;
        repair.label = expression ? "what is to be computed stands in quotes: `\"$r * 2\"`"
                                  : "a name that begins with a digit needs quotes";
        repair.first.clear();
        repair.lost = true;
    }
    return repair;
}

} // namespace abbe::parser
