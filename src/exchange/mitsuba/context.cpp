#include "exchange/mitsuba/context.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

void wrongType(const XmlParam& param, std::string_view wanted, Import& import) {
    if (param.tag == kBrokenTag) return;
    import.diagnostics.error("E0802", param.span,
                             fmt::format("`{}` is {} here, not `<{}>`", param.name, wanted, param.tag));
}

bool isDiagonal(const Transform& m) {
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
            if (r != c && m.a[r][c] != 0) return false;
    return true;
}

} // namespace

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
        std::string word = param->text;
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
    return param && param->tag == "string" ? param->text : std::string(otherwise);
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
    return param ? param->transform : Transform{};
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

bool isIdentity(const Transform& m) {
    return isDiagonal(m) && m.a[0][0] == 1 && m.a[1][1] == 1 && m.a[2][2] == 1 && m.t == Vec3d();
}

void writeTransform(SceneNode& parent, const Transform& m) {
    if (isIdentity(m)) return;
    SceneNode& block = parent.child("transform");
    if (!isDiagonal(m)) {
        SceneNode& matrix = block.child("matrix");
        for (int r = 0; r < 3; ++r) matrix.number(m.a[r][0]).number(m.a[r][1]).number(m.a[r][2]).number(m.t[r]);
        for (const double value : {0, 0, 0, 1}) matrix.number(value);
        return;
    }
    const Vec3d s(m.a[0][0], m.a[1][1], m.a[2][2]);
    if (s.x == s.y && s.y == s.z && s.x != 1)
        block.child("scale").number(s.x);
    else if (!(s == Vec3d(1, 1, 1)))
        block.child("scale").vector(s);
    if (!(m.t == Vec3d())) block.child("translate").vector(m.t);
}

} // namespace abbe::exchange
