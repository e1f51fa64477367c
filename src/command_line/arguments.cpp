#include "command_line/arguments.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace abbe {

namespace {

std::optional<Vec2i> readPair(std::string_view text, std::string_view separator, int lowest) {
    const std::size_t at = text.find(separator);
    if (at == std::string_view::npos) return std::nullopt;
    const auto number = [&](std::string_view digits) -> std::optional<int> {
        int value = 0;
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        if (error != std::errc() || end != digits.data() + digits.size() || value < lowest) return std::nullopt;
        return value;
    };
    const auto x = number(text.substr(0, at)), y = number(text.substr(at + separator.size()));
    if (!x || !y) return std::nullopt;
    return Vec2i{*x, *y};
}

constexpr int kLowest = -65536; // in the overscan

} // namespace

std::optional<Vec2i> readSize(std::string_view text) {
    if (const auto size = readPair(text, "x", 1)) return size;
    return readPair(text, "×", 1);
}

std::optional<Vec2i> readPixel(std::string_view text) { return readPair(text, ",", 0); }
std::optional<Vec2i> readAnyPixel(std::string_view text) { return readPair(text, ",", kLowest); }

std::optional<PixelBounds> readCrop(std::string_view text) {
    const std::size_t first = text.find(','), second = text.find(',', std::min(first, text.size() - 1) + 1);
    if (first == std::string_view::npos || second == std::string_view::npos) return std::nullopt;
    const auto from = readPair(text.substr(0, second), ",", kLowest);
    const auto to = readPair(text.substr(second + 1), ",", kLowest);
    if (!from || !to || to->x <= from->x || to->y <= from->y) return std::nullopt;
    return PixelBounds{from->x, from->y, to->x, to->y};
}

std::optional<SampleId> readSample(std::string_view text) {
    const auto sample = readPair(text, ":", 0);
    if (!sample) return std::nullopt;
    return SampleId{0, 0, sample->x, static_cast<std::uint32_t>(sample->y)};
}

std::optional<Vec2i> readPart(std::string_view text) {
    const auto part = readPair(text, "/", 1);
    return part && part->x <= part->y ? part : std::nullopt;
}

std::optional<double> readQuantity(std::string_view text, schema::Dimension dimension) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
    std::string_view unit = text.substr(static_cast<std::size_t>(end - text.data()));
    while (!unit.empty() && unit.front() == ' ') unit.remove_prefix(1);
    if (unit.empty()) return value;
    const auto found = schema::findUnit(unit);
    if (!found || found->dimension != dimension) return std::nullopt;
    return value * found->scale;
}

std::optional<double> readMebibytes(std::string_view text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc()) return std::nullopt;
    std::string_view unit = text.substr(static_cast<std::size_t>(end - text.data()));
    while (!unit.empty() && unit.front() == ' ') unit.remove_prefix(1);
    if (unit == "GiB") value *= 1024;
    if (!(unit.empty() || unit == "MiB" || unit == "GiB") || !(value >= 16 && value <= 1e9)) return std::nullopt;
    return value;
}

Argument& Arguments::argument(const char* name, Argument::Place place, std::string help) {
    return value(name, "", std::move(place), std::move(help));
}

Argument& Arguments::flag(const char* names, Argument::Place place, std::string help) {
    return value(names, "", std::move(place), std::move(help));
}

Argument& Arguments::value(const char* names, const char* shown, Argument::Place place, std::string help) {
    Argument a;
    a.names = names;
    a.value = shown;
    a.help = std::move(help);
    a.place = std::move(place);
    return all_.emplace_back(std::move(a));
}

Argument& Arguments::addChoice(const char* names, std::vector<std::string> words, Argument::TextReader reader,
                               std::string help) {
    std::string shown;
    for (const std::string& word : words) shown += (shown.empty() ? "" : "|") + word;
    Argument& a = value(names, shown.c_str(), std::move(reader), std::move(help));
    a.choices = std::move(words);
    return a;
}

std::string Arguments::notExpected(const std::string& text, const char* expected) {
    return "`" + text + "` is not " + expected;
}

} // namespace abbe
