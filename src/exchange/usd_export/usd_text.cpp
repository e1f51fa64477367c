#include "exchange/usd_export/usd_text.h"

#include <cmath>

namespace abbe::exchange {

std::string usdNumber(double v) {
    if (std::isinf(v)) return v > 0 ? "inf" : "-inf";
    return fmt::format("{}", v == 0 ? 0.0 : v);
}

std::string usdFloat(double v) {
    const auto f = static_cast<float>(v);
    if (std::isinf(f)) return f > 0 ? "inf" : "-inf";
    return fmt::format("{}", f == 0 ? 0.0f : f);
}

std::string usdFloats(Vec3d v) { return fmt::format("({}, {}, {})", usdFloat(v.x), usdFloat(v.y), usdFloat(v.z)); }

std::string usdText(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        if (c == '\n')
            out += "\\n";
        else
            out += c;
    }
    return out + '"';
}

std::string usdFile(std::string_view path) {
    return path.find('@') == std::string_view::npos ? fmt::format("@{}@", path) : fmt::format("@@@{}@@@", path);
}

std::string usdMatrix(const Transform& m) {
    std::string text = "(";
    for (int c = 0; c < 3; ++c)
        text += fmt::format("({}, {}, {}, 0), ", usdNumber(m.a[0][c]), usdNumber(m.a[1][c]), usdNumber(m.a[2][c]));
    return text + fmt::format("({}, {}, {}, 1))", usdNumber(m.t.x), usdNumber(m.t.y), usdNumber(m.t.z));
}

std::string usdPoints(const std::vector<Vec3>& list) {
    return usdArray(list, [](Vec3 p) { return usdFloats(Vec3d(p)); });
}

std::string usdPairs(const std::vector<Vec2>& list) {
    return usdArray(list, [](Vec2 p) {
        return fmt::format("({}, {})", usdFloat(static_cast<double>(p.x)), usdFloat(static_cast<double>(p.y)));
    });
}

std::string usdIndices(const std::vector<std::uint32_t>& list) {
    return usdArray(list, [](std::uint32_t i) { return fmt::format("{}", i); });
}

UsdPrim& UsdPrim::set(std::string_view declaration, std::string_view value) {
    lines_.push_back(fmt::format("{} = {}", declaration, value));
    return *this;
}

UsdPrim& UsdPrim::set(std::string_view declaration, std::string_view value, std::string_view metadata) {
    lines_.push_back(fmt::format("{} = {} ({})", declaration, value, metadata));
    return *this;
}

UsdPrim& UsdPrim::declare(std::string_view declaration) {
    lines_.emplace_back(declaration);
    return *this;
}

UsdPrim& UsdPrim::samples(std::string_view declaration, const std::vector<std::pair<double, std::string>>& values) {
    std::string text = fmt::format("{}.timeSamples = {{ ", declaration);
    for (const auto& [code, value] : values) text += fmt::format("{}: {}, ", usdNumber(code), value);
    lines_.push_back(text + "}");
    return *this;
}

UsdPrim& UsdPrim::metadata(std::string line) {
    metadata_.push_back(std::move(line));
    return *this;
}

UsdPrim& UsdPrim::api(std::string_view schema) {
    apis_.emplace_back(schema);
    return *this;
}

UsdPrim& UsdPrim::remark(const std::vector<std::string>& lines) {
    remarks_.insert(remarks_.end(), lines.begin(), lines.end());
    return *this;
}

UsdPrim& UsdPrim::specifier(std::string word) {
    specifier_ = std::move(word);
    return *this;
}

UsdPrim& UsdPrim::add(UsdPrim child) {
    children_.push_back(std::move(child));
    return *this;
}

void UsdPrim::write(std::string& to, int indent) const {
    const std::string pad(static_cast<std::size_t>(indent), ' '), inner = pad + "    ";
    for (std::string remark : remarks_) {
        for (char& c : remark)
            if (c == '\n') c = ' ';
        to += fmt::format("{}# {}\n", pad, remark);
    }
    to += fmt::format("{}{} {}{}\"{}\"", pad, specifier_, type_, type_.empty() ? "" : " ", name_);
    if (!metadata_.empty() || !apis_.empty()) {
        to += " (\n";
        if (!apis_.empty()) to += fmt::format("{}prepend apiSchemas = {}\n", inner, usdArray(apis_, usdText));
        for (const std::string& line : metadata_) to += fmt::format("{}{}\n", inner, line);
        to += pad + ")";
    }
    to += fmt::format("\n{}{{\n", pad);
    for (const std::string& line : lines_) to += fmt::format("{}{}\n", inner, line);
    for (const UsdPrim& child : children_) child.write(to, indent + 4);
    to += pad + "}\n";
}

} // namespace abbe::exchange
