#include "exchange/mitsuba/context.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

void wrongType(const XmlParam& param, std::string_view wanted, Import& import) {
    if (param.tag == kBrokenTag) return;
    import.diagnostics.error("E0802", param.span,
                             fmt::format("`{}` is {} here, not `<{}>`", param.name, wanted, param.tag));
}

} // namespace

void MitsubaContext::noteBounds(const Bounds3d& box, const Transform& place) {
    if (box.empty()) return;
    const Vec3d middle = place.point((box.lower + box.upper) * 0.5), half = (box.upper - box.lower) * 0.5;
    const auto reach = [&](const auto& row) {
        return std::abs(row[0]) * half.x + std::abs(row[1]) * half.y + std::abs(row[2]) * half.z;
    };
    const Vec3d around{reach(place.a[0]), reach(place.a[1]), reach(place.a[2])};
    bounds.add(middle - around);
    bounds.add(middle + around);
}

double mitsubaNumber(const XmlObject& object, std::string_view name, double otherwise, Import& import) {
    const XmlParam* const param = object.find(name);
    if (!param) return otherwise;
    if (param->numbers.size() == 1) return param->numbers[0];
    wrongType(*param, "a number", import);
    return otherwise;
}

bool mitsubaFlag(const XmlObject& object, std::string_view name, bool otherwise, Import& import) {
    const XmlParam* const param = object.find(name);
    if (!param) return otherwise;
    if (param->tag == "boolean") {
        std::string word(param->text);
        std::ranges::transform(word, word.begin(),
                               [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
        if (word == "true" || word == "1") return true;
        if (word == "false" || word == "0") return false;
    }
    wrongType(*param, "`true` or `false`", import);
    return otherwise;
}

std::string mitsubaText(const XmlObject& object, std::string_view name, std::string_view otherwise) {
    const XmlParam* const param = object.find(name);
    return std::string(param && param->tag == "string" ? param->text : otherwise);
}

std::optional<Vec3d> mitsubaVector(const XmlObject& object, std::string_view name, Import& import) {
    const XmlParam* const param = object.find(name);
    if (!param) return std::nullopt;
    if (param->numbers.size() == 3) return Vec3d(param->numbers[0], param->numbers[1], param->numbers[2]);
    wrongType(*param, "three numbers", import);
    return std::nullopt;
}

Transform mitsubaTransform(const XmlObject& object, std::string_view name) {
    const XmlParam* const param = object.find(name);
    return param && param->transform ? *param->transform : Transform{};
}

void mitsubaIgnore(const XmlObject& object, std::initializer_list<std::string_view> names) {
    for (const std::string_view name : names) object.find(name);
}

void warnOfUnused(const XmlObject& object, Import& import) {
    for (const XmlParam& param : object.params) {
        if (param.used) continue;
        param.used = true; // once
        import.diagnostics.warning(
            "W0803", param.span,
            param.name.empty()
                ? fmt::format("`{}` of type `{}` has no use for this `{}`", object.tag, object.plugin, param.tag)
                : fmt::format("`{}` of type `{}` has no parameter `{}`", object.tag, object.plugin, param.name));
    }
}

} // namespace abbe::exchange
