#include "exchange/pbrt_export/pbrt_writer.h"
#include "spectrum/sensor.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

std::string quotedForPbrt(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        if (static_cast<unsigned char>(c) >= 32) out += c;
    }
    return out + "\"";
}

std::string vectorText(Vec3d v) {
    const double most = maxComponent(abs(v));
    return fmt::format("{} {} {}", pbrtNumber(v.x, most), pbrtNumber(v.y, most), pbrtNumber(v.z, most));
}

std::string pbrtTable(const PlainSpectrum& s) {
    std::string text;
    const auto add = [&](double nm, double value) {
        text += fmt::format("{}{} {}", text.empty() ? "" : " ", pbrtNumber(nm), fmt::format("{:.7g}", value));
    };
    if (s.rows.empty()) return "360 0 830 0";
    // Reflectances go on beyond the ends of a table here; pbrt's are zero there.
    if (!s.light && s.rows.front().first > 360 && s.rows.front().second != 0) add(360, s.rows.front().second);
    for (const auto& [nm, value] : s.rows) add(nm, value);
    if (!s.light && s.rows.back().first < 830 && s.rows.back().second != 0) add(830, s.rows.back().second);
    return text;
}

} // namespace

std::string pbrtNumber(double value, double largest) {
    if (std::abs(value) <= 1e-14 * largest) value = 0;
    return fmt::format("{:.9g}", value == 0 ? 0.0 : value);
}

PbrtList& PbrtList::add(std::string_view type, std::string_view name, std::string_view values) {
    text_ += fmt::format(" \"{} {}\" [ {} ]", type, name, values);
    return *this;
}

PbrtList& PbrtList::text(std::string_view type, std::string_view name, std::string_view value) {
    return add(type, name, quotedForPbrt(value));
}

PbrtList& PbrtList::point(std::string_view name, Vec3d v) { return add("point3", name, vectorText(v)); }

PbrtList& PbrtList::spectrum(std::string_view name, const PlainSpectrum& s) {
    switch (s.form) {
    case PlainSpectrum::Form::flat:
        if (s.light) return add("spectrum", name, fmt::format("360 {0} 830 {0}", pbrtNumber(s.value)));
        return add("rgb", name, fmt::format("{0} {0} {0}", pbrtNumber(s.value)));
    case PlainSpectrum::Form::rgb:
        return add("rgb", name, fmt::format("{} {} {}", pbrtNumber(s.rgb.x), pbrtNumber(s.rgb.y), pbrtNumber(s.rgb.z)));
    case PlainSpectrum::Form::blackbody:
        return add("blackbody", name, pbrtNumber(s.value));
    case PlainSpectrum::Form::table:
        break;
    }
    return add("spectrum", name, pbrtTable(s));
}

std::string PbrtWriter::take(NameTable& table, std::string_view wish, std::string_view fallback) {
    std::string name(wish);
    std::ranges::replace_if(
        name, [](char c) { return c == '"' || c == '\\' || static_cast<unsigned char>(c) < 32; }, '_');
    return table.take(name, fallback);
}

std::string PbrtWriter::remarks(std::string_view indent) {
    std::string text;
    for (const std::string& remark : out.takeRemarks()) {
        std::string line = remark;
        std::ranges::replace(line, '\n', ' ');
        text += fmt::format("{}# {}\n", indent, line);
    }
    return text;
}

Vec3d pbrtMirrored(Vec3d p) { return {-p.x, p.y, p.z}; }

Transform pbrtMirrored(const Transform& toWorld) { return toWorld.then(Transform::scale({-1, 1, 1})); }

std::string pbrtPlace(const Transform& toWorld) {
    const Transform m = pbrtMirrored(toWorld);
    double most = 0;
    for (const auto& row : m.a)
        for (const double v : row) most = std::max(most, std::abs(v));
    std::string text = "Transform [";
    for (int c = 0; c < 3; ++c) {
        for (int r = 0; r < 3; ++r) text += " " + pbrtNumber(m.a[r][c], most);
        text += " 0";
    }
    const double far = maxComponent(abs(m.t));
    for (int r = 0; r < 3; ++r) text += " " + pbrtNumber(m.t[r], far);
    text += " 1 ]";
    return text == "Transform [ 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 ]" ? std::string() : text;
}

void pbrtWriteLight(PbrtList& list, std::string_view name, const StatedLight& light) {
    const PlainSpectrum s = plainSpectrum(*light.curve);
    const bool colour = s.form == PlainSpectrum::Form::rgb;
    const bool white = colour && s.rgb == Vec3d(1, 1, 1); // what pbrt takes when nothing is said
    if (!white) list.spectrum(name, s);
    // All but colours are divided by their luminance there.
    const double scale = colour ? light.scale : light.scale * luminanceOf(*light.curve, exactUnits());
    if (pbrtNumber(scale) != "1") list.number("scale", scale);
}

void pbrtWriteColor(PbrtList& list, std::string_view name, const StatedSpectrum& s, PbrtWriter& w) {
    const std::string texture = s.texture ? pbrtTextureName(*s.texture, true, w) : std::string();
    if (!texture.empty())
        list.text("texture", name, texture);
    else if (s.texture)
        list.add("rgb", name, "0.5 0.5 0.5");
    else if (s.curve)
        list.spectrum(name, plainSpectrum(*s.curve));
}

void pbrtWriteAmount(PbrtList& list, std::string_view name, const StatedNumber& n, PbrtWriter& w) {
    const std::string texture = n.texture ? pbrtTextureName(*n.texture, false, w) : std::string();
    if (!texture.empty())
        list.text("texture", name, texture);
    else
        list.number(name, n.texture ? 0.5 : n.value);
}

} // namespace abbe::exchange
