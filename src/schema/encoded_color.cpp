#include "schema/encoded_color.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::schema {

namespace {

std::optional<int> hexDigit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return std::nullopt;
}

std::string colorText(std::string_view word, const std::array<double, 3>& v, double divisor) {
    return fmt::format("`{} {:.3g} {:.3g} {:.3g}`", word, v[0] / divisor, v[1] / divisor, v[2] / divisor);
}

} // namespace

// [IEC61966-2-1]
double decodeSrgb(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }

std::optional<std::array<double, 3>> parseHex(std::string_view text) {
    if (!text.starts_with('#') || (text.size() != 4 && text.size() != 7)) return std::nullopt;
    const std::size_t digits = (text.size() - 1) / 3;
    std::array<double, 3> rgb{};
    for (std::size_t i = 0; i < 3; ++i) {
        const auto high = hexDigit(text[1 + i * digits]), low = hexDigit(text[i * digits + digits]);
        if (!high || !low) return std::nullopt;
        rgb[i] = (*high * 16 + *low) / 255.0;
    }
    return rgb;
}

void suggestHex(const Value& word, Diagnostic& d) {
    const auto encoded = parseHex(word.text);
    if (!encoded) return;
    const std::array<double, 3> linear = {decodeSrgb((*encoded)[0]), decodeSrgb((*encoded)[1]),
                                          decodeSrgb((*encoded)[2])};
    d.label = fmt::format("write `srgb \"{}\"`", word.text);
    d.help = fmt::format("in linear numbers of Rec. 709 it is {}", colorText("rgb", linear, 1));
    if (word.kind == ValueKind::string && !word.use.valid())
        d.fixes.push_back({{word.span.file, word.span.begin, word.span.begin}, "srgb "});
}

std::string dividedColor(const Entry& entry, std::size_t first) {
    if (entry.count() < first + 3) return {};
    std::array<double, 3> numbers{};
    for (std::size_t i = 0; i < 3; ++i) {
        const Value value = entry.value(first + i);
        if (value.kind != ValueKind::number || !(value.number >= 0 && value.number <= 255)) return {};
        numbers[i] = value.number;
    }
    const double largest = *std::ranges::max_element(numbers);
    if (!(largest > 1.5)) return {};
    const std::string bytes =
        fmt::format("numbers of a picture or colour picker, divided by 255, are {}; if they are linear, {}",
                    colorText("srgb", numbers, 255), colorText("rgb", numbers, 255));
    return largest > 100 ? bytes
                         : fmt::format("{}; percent, divided by 100, are {}", bytes, colorText("rgb", numbers, 100));
}

} // namespace abbe::schema
