#include "exchange/mitsuba/xml_values.h"

#include "exchange/shared/decimal.h"

#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

using XmlAttribute = std::function<std::string_view(const char*)>;

bool isXmlBlank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == ','; }

// Exactly so many numbers.
template <std::size_t N> std::optional<std::array<double, N>> exactly(std::string_view text) {
    std::array<double, N> numbers{};
    return xmlNumbers(text, numbers) == N ? std::optional(numbers) : std::nullopt;
}

// x, y and z, or `value` with one number or three.
std::optional<Vec3d> xmlTriple(const XmlAttribute& attribute, double otherwise) {
    std::array<double, 3> v{};
    if (const std::string_view value = attribute("value"); !value.empty()) {
        const auto count = xmlNumbers(value, v);
        if (count == 1) return Vec3d(v[0], v[0], v[0]);
        return count == 3 ? std::optional(Vec3d(v[0], v[1], v[2])) : std::nullopt;
    }
    constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};
    for (std::size_t i = 0; i < 3; ++i) {
        const std::string_view text = attribute(kAxes[i]);
        v[i] = otherwise;
        if (!text.empty() && xmlNumbers(text, std::span(v).subspan(i, 1)) != 1) return std::nullopt;
    }
    return Vec3d(v[0], v[1], v[2]);
}

std::optional<Vec3d> xmlPoint(std::string_view text) {
    const auto numbers = exactly<3>(text);
    return numbers ? std::optional(Vec3d((*numbers)[0], (*numbers)[1], (*numbers)[2])) : std::nullopt;
}

// 16 numbers row by row, or 9 of the upper left.
XmlStep xmlMatrix(std::string_view text) {
    std::array<double, 16> numbers{};
    const auto count = xmlNumbers(text, numbers);
    if (count != 16 && count != 9) return {{}, "a matrix has 16 numbers, or 9"};
    const std::size_t n = count == 16 ? 4 : 3;
    Transform map;
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) map.a[r][c] = numbers[r * n + c];
    if (n == 4) {
        map.t = {numbers[3], numbers[7], numbers[11]};
        if (numbers[12] != 0 || numbers[13] != 0 || numbers[14] != 0 || numbers[15] != 1)
            return {{}, "the last row of a matrix is 0 0 0 1"};
    }
    return {map, {}};
}

// Mitsuba's cameras look along their +z with +x to the left [Mitsuba 3 documentation, "Sensors"].
XmlStep xmlLookAt(const XmlAttribute& attribute) {
    const auto origin = xmlPoint(attribute("origin")), target = xmlPoint(attribute("target"));
    if (!origin || !target) return {{}, "it needs `origin` and `target` of three numbers"};
    const std::string_view upText = attribute("up");
    const auto up = upText.empty() ? std::optional(Vec3d(0, 1, 0)) : xmlPoint(upText);
    if (!up) return {{}, "`up` has three numbers"};
    const Vec3d forward = *target - *origin;
    if (!(lengthSquared(forward) > 0)) return {{}, "`origin` and `target` are the same point"};
    const Vec3d dir = normalize(forward);
    const Vec3d side = cross(*up, dir);
    if (!(length(side) > 1e-12 * length(*up))) return {{}, "`up` is parallel to the direction of view"};
    const Vec3d left = normalize(side), newUp = cross(dir, left);
    Transform map;
    const Vec3d columns[3] = {left, newUp, dir};
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) map.a[r][c] = columns[c][r];
    map.t = *origin;
    return {map, {}};
}

// Rodrigues' formula with the axis as it is written, as Mitsuba has it: one that is no unit vector also stretches.
Transform xmlRotation(Vec3d axis, double radians) {
    // Right angles are what they are.
    const auto exact = [](double v) {
        return std::abs(v) < 1e-15 ? 0 : std::abs(v) > 1 - 1e-15 ? std::copysign(1.0, v) : v;
    };
    const double s = exact(std::sin(radians)), c = exact(std::cos(radians));
    const double cross[3][3] = {{0, -axis.z, axis.y}, {axis.z, 0, -axis.x}, {-axis.y, axis.x, 0}};
    Transform map;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) map.a[i][j] = (i == j ? c : 0) + s * cross[i][j] + (1 - c) * axis[i] * axis[j];
    return map;
}

} // namespace

namespace {

// Calls `take` for every number; false if something else is there.
template <typename F> bool forNumbers(std::string_view text, const F& take) {
    for (const char *at = text.data(), *const last = at + text.size();;) {
        while (at != last && isXmlBlank(*at)) ++at;
        if (at == last) return true;
        if (*at == '+') ++at;
        double value = 0;
        const auto [end, error] = parseDecimal(at, last, value);
        if (error != std::errc() || !std::isfinite(value)) return false;
        if (end != last && !isXmlBlank(*end)) return false;
        at = end;
        take(value);
    }
}

} // namespace

std::optional<std::vector<double>> xmlNumbers(std::string_view text) {
    std::vector<double> list;
    return forNumbers(text, [&](double value) { list.push_back(value); }) ? std::optional(std::move(list))
                                                                          : std::nullopt;
}

std::optional<std::size_t> xmlNumbers(std::string_view text, std::span<double> into) {
    std::size_t count = 0;
    const bool sound = forNumbers(text, [&](double value) {
        if (count < into.size()) into[count] = value;
        ++count;
    });
    return sound ? std::optional(count) : std::nullopt;
}

std::optional<std::array<double, 3>> xmlHexColor(std::string_view text) {
    if (text.size() != 7 || text[0] != '#') return std::nullopt;
    std::array<double, 3> rgb{};
    for (std::size_t i = 0; i < 3; ++i) {
        const char* const digits = text.data() + 1 + 2 * i;
        int value = 0;
        const auto [end, error] = std::from_chars(digits, digits + 2, value, 16);
        if (error != std::errc() || end != digits + 2) return std::nullopt;
        const double c = value / 255.0; // IEC 61966-2-1
        rgb[i] = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
    }
    return rgb;
}

XmlStep xmlStep(std::string_view tag, const XmlAttribute& attribute) {
    if (tag == "matrix") return xmlMatrix(attribute("value"));
    if (tag == "lookat" || tag == "lookAt") return xmlLookAt(attribute);
    if (tag != "translate" && tag != "scale" && tag != "rotate")
        return {{},
                fmt::format("`{}` is no step of a transform: translate, rotate, scale, matrix and lookat are", tag)};
    const auto v = xmlTriple(attribute, tag == "scale" ? 1 : 0);
    if (!v) return {{}, "it needs numbers"};
    if (tag == "translate") return {Transform::translate(*v), {}};
    if (tag == "scale") return {Transform::scale(*v), {}};
    const auto angle = exactly<1>(attribute("angle"));
    if (!angle) return {{}, "it needs an `angle`"};
    if (!(lengthSquared(*v) > 0)) return {{}, "it needs an axis: x, y and z are 0"};
    return {xmlRotation(*v, (*angle)[0] * kDegree), {}};
}

} // namespace abbe::exchange
