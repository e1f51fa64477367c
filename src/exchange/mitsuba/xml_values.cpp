#include "exchange/mitsuba/xml_values.h"

#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

using XmlAttribute = std::function<std::string(const char*)>;

bool isXmlBlank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == ','; }

// x, y and z, or `value` with one number or three.
std::optional<Vec3d> xmlTriple(const XmlAttribute& attribute, double otherwise) {
    Vec3d v{otherwise, otherwise, otherwise};
    if (const std::string value = attribute("value"); !value.empty()) {
        const auto numbers = xmlNumbers(value);
        if (!numbers || (numbers->size() != 1 && numbers->size() != 3)) return std::nullopt;
        return numbers->size() == 1 ? Vec3d((*numbers)[0], (*numbers)[0], (*numbers)[0])
                                    : Vec3d((*numbers)[0], (*numbers)[1], (*numbers)[2]);
    }
    const auto part = [&](const char* name, double& to) {
        const std::string text = attribute(name);
        if (text.empty()) return true;
        const auto numbers = xmlNumbers(text);
        if (!numbers || numbers->size() != 1) return false;
        to = (*numbers)[0];
        return true;
    };
    if (!part("x", v.x) || !part("y", v.y) || !part("z", v.z)) return std::nullopt;
    return v;
}

std::optional<Vec3d> xmlPoint(const std::string& text) {
    const auto numbers = xmlNumbers(text);
    if (!numbers || numbers->size() != 3) return std::nullopt;
    return Vec3d((*numbers)[0], (*numbers)[1], (*numbers)[2]);
}

// 16 numbers row by row, or 9 of the upper left.
XmlStep xmlMatrix(const std::string& text) {
    const auto numbers = xmlNumbers(text);
    if (!numbers || (numbers->size() != 16 && numbers->size() != 9)) return {{}, "a matrix has 16 numbers, or 9"};
    const std::size_t n = numbers->size() == 16 ? 4 : 3;
    Transform map;
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) map.a[r][c] = (*numbers)[r * n + c];
    if (n == 4) {
        map.t = {(*numbers)[3], (*numbers)[7], (*numbers)[11]};
        if ((*numbers)[12] != 0 || (*numbers)[13] != 0 || (*numbers)[14] != 0 || (*numbers)[15] != 1)
            return {{}, "the last row of a matrix is 0 0 0 1"};
    }
    return {map, {}};
}

// Mitsuba's cameras look along their +z with +x to the left [Mitsuba 3 documentation, "Sensors"].
XmlStep xmlLookAt(const XmlAttribute& attribute) {
    const auto origin = xmlPoint(attribute("origin")), target = xmlPoint(attribute("target"));
    if (!origin || !target) return {{}, "it needs `origin` and `target` of three numbers"};
    const std::string upText = attribute("up");
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

std::optional<std::vector<double>> xmlNumbers(std::string_view text) {
    std::vector<double> list;
    for (std::size_t at = 0;;) {
        while (at < text.size() && isXmlBlank(text[at])) ++at;
        if (at == text.size()) return list;
        if (text[at] == '+') ++at;
        double value = 0;
        const auto [end, error] = std::from_chars(text.data() + at, text.data() + text.size(), value);
        if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
        at = static_cast<std::size_t>(end - text.data());
        if (at < text.size() && !isXmlBlank(text[at])) return std::nullopt;
        list.push_back(value);
    }
}

std::optional<std::vector<double>> xmlHexColor(std::string_view text) {
    if (text.size() != 7 || text[0] != '#') return std::nullopt;
    std::vector<double> rgb;
    for (std::size_t i = 1; i < 7; i += 2) {
        int value = 0;
        const auto [end, error] = std::from_chars(text.data() + i, text.data() + i + 2, value, 16);
        if (error != std::errc() || end != text.data() + i + 2) return std::nullopt;
        const double c = value / 255.0; // IEC 61966-2-1
        rgb.push_back(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
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
    const auto angle = xmlNumbers(attribute("angle"));
    if (!angle || angle->size() != 1) return {{}, "it needs an `angle`"};
    if (!(lengthSquared(*v) > 0)) return {{}, "it needs an axis: x, y and z are 0"};
    return {xmlRotation(*v, (*angle)[0] * kDegree), {}};
}

} // namespace abbe::exchange
