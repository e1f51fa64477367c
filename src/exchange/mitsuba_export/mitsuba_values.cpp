#include "exchange/mitsuba_export/mitsuba_writer.h"
#include "exchange/shared/placement.h"
#include "exchange/shared/scene_node.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

// Reflectances go on beyond the ends of a table; Mitsuba's tables are zero there.
std::string tableText(const PlainSpectrum& s) {
    std::string text;
    const auto add = [&](double nm, double value) {
        text += fmt::format("{}{}:{}", text.empty() ? "" : ", ", numberText(nm), numberText(value));
    };
    if (s.rows.empty()) return "360:0, 830:0";
    if (!s.light && s.rows.front().first > 360 && s.rows.front().second != 0) add(360, s.rows.front().second);
    for (const auto& [nm, value] : s.rows) add(nm, value);
    if (!s.light && s.rows.back().first < 830 && s.rows.back().second != 0) add(830, s.rows.back().second);
    return text;
}

// The one texture in the place of another that Mitsuba lacks: its mean, grey.
void leaveOutTexture(pugi::xml_node parent, std::string_view name, const StatedThing& texture, MitsubaWriter& w) {
    w.out.leftOut(texture.span, fmt::format("texture `{}`", texture.type),
                  "Mitsuba has nothing like it; grey stands for it");
    xmlValue(parent, "spectrum", name, "0.5");
}

void writeBitmapTexture(pugi::xml_node node, const StatedThing& texture, bool data, MitsubaWriter& w) {
    const auto* const file = texture.value<schema::Text>("file");
    if (!file) return;
    xmlValue(node, "string", "filename", w.out.files.refer(file->value));
    for (const auto& [key, value] : file->keys) {
        const bool known = value == "data" || value == "srgb_rec709_scene";
        if (key == "space" && !known)
            w.out.approximated(file->span, fmt::format("`space={}`", value), "Mitsuba goes by the file itself");
        if (key == "space" && value == "data") data = true;
    }
    xmlFlag(node, "raw", data);
    const std::string wrap = texture.word("wrap");
    if (wrap == "mirror" || wrap == "clamp") xmlValue(node, "string", "wrap_mode", wrap);
    if (wrap == "black") w.out.approximated(texture.span, "`wrap black`", "the picture is repeated");
}

// Squares of half a unit. Turning v over exchanges two colours; where that would not do, v is turned back. In the place
// of a number Mitsuba exchanges them itself.
void writeCheckerTexture(pugi::xml_node node, const StatedThing& texture, bool data, MitsubaWriter& w) {
    const auto* const scale = texture.quantity("scale");
    const bool cubes = scale && scale->dimension == schema::Dimension::length;
    const double stated = texture.number("scale", 8), squares = cubes ? 1 / stated : stated;
    if (cubes) w.out.approximated(texture.span, "`checker` in cubes", "by squares over the texture coordinates");
    const bool exchanged = (squares == 2) != data;
    const auto color = [&](const char* name, bool odd) {
        if (const StatedSpectrum s = texture.spectrum(odd ? "odd" : "even"))
            writeMitsubaColor(node, name, s, 1, w);
        else
            xmlValue(node, "spectrum", name, odd ? "0.2" : "0.8");
    };
    color("color0", exchanged);
    color("color1", !exchanged);
    if (squares == 2) return;
    xmlTransform(node, Transform::scale({squares / 2, -squares / 2, 1}).then(Transform::translate({0, squares / 2, 0})),
                 "to_uv");
}

} // namespace

std::string MitsubaWriter::takeId(std::string_view wish, std::string_view fallback) {
    std::string id(wish);
    std::ranges::replace(id, '.', '_');
    return ids.take(id, fallback);
}

void MitsubaWriter::remark(pugi::xml_node before) {
    for (std::string text : out.takeRemarks()) {
        for (std::size_t at; (at = text.find("--")) != std::string::npos;) text.replace(at, 2, "- ");
        before.parent().insert_child_before(pugi::node_comment, before).set_value((" " + text + " ").c_str());
    }
}

void xmlValue(pugi::xml_node parent, const char* tag, std::string_view name, std::string_view value) {
    pugi::xml_node node = parent.append_child(tag);
    node.append_attribute("name") = std::string(name).c_str();
    node.append_attribute("value") = std::string(value).c_str();
}

void xmlNumber(pugi::xml_node parent, std::string_view name, double value) {
    xmlValue(parent, "float", name, numberText(value));
}

void xmlFlag(pugi::xml_node parent, std::string_view name, bool value) {
    xmlValue(parent, "boolean", name, value ? "true" : "false");
}

pugi::xml_node xmlChild(pugi::xml_node parent, const char* tag, std::string_view type, std::string_view name,
                        std::string_view id) {
    pugi::xml_node node = parent.append_child(tag);
    node.append_attribute("type") = std::string(type).c_str();
    if (!name.empty()) node.append_attribute("name") = std::string(name).c_str();
    if (!id.empty()) node.append_attribute("id") = std::string(id).c_str();
    return node;
}

void xmlTransform(pugi::xml_node parent, const Transform& map, std::string_view name) {
    if (isIdentity(map)) return;
    pugi::xml_node node = parent.append_child("transform");
    node.append_attribute("name") = std::string(name).c_str();
    std::string text;
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) text += numberText(map.a[r][c]) + " ";
        text += numberText(map.t[r]) + " ";
    }
    node.append_child("matrix").append_attribute("value") = (text + "0 0 0 1").c_str();
}

void xmlSpectrum(pugi::xml_node parent, std::string_view name, const PlainSpectrum& s) {
    switch (s.form) {
    case PlainSpectrum::Form::flat:
        return xmlValue(parent, "spectrum", name, numberText(s.value));
    case PlainSpectrum::Form::rgb:
        if (!s.rows.empty()) return xmlValue(parent, "spectrum", name, tableText(s)); // colours there are at most 1
        return xmlValue(parent, "rgb", name,
                        fmt::format("{} {} {}", numberText(s.rgb.x), numberText(s.rgb.y), numberText(s.rgb.z)));
    case PlainSpectrum::Form::blackbody:
        return xmlNumber(xmlChild(parent, "spectrum", "blackbody", name), "temperature", s.value);
    case PlainSpectrum::Form::table:
        return xmlValue(parent, "spectrum", name, tableText(s));
    }
}

void writeMitsubaColor(pugi::xml_node parent, std::string_view name, const StatedSpectrum& s, double scale,
                       MitsubaWriter& w) {
    if (s.texture) {
        if (scale != 1)
            w.out.approximated(s.texture->span, "the brightness of a texture", "Mitsuba shows it as it is stored");
        return writeMitsubaTexture(parent, name, *s.texture, false, w);
    }
    if (s.curve) xmlSpectrum(parent, name, plainSpectrum(*s.curve, scale));
}

void writeMitsubaNumber(pugi::xml_node parent, std::string_view name, const StatedNumber& n, MitsubaWriter& w) {
    if (n.texture)
        writeMitsubaTexture(parent, name, *n.texture, true, w);
    else
        xmlNumber(parent, name, n.value);
}

void writeMitsubaTexture(pugi::xml_node parent, std::string_view name, const StatedThing& texture, bool data,
                         MitsubaWriter& w) {
    if (texture.type == "image") {
        writeBitmapTexture(xmlChild(parent, "texture", "bitmap", name), texture, data, w);
    } else if (texture.type == "checker") {
        writeCheckerTexture(xmlChild(parent, "texture", "checkerboard", name), texture, data, w);
    } else if (texture.type == "attribute") {
        xmlValue(xmlChild(parent, "texture", "mesh_attribute", name), "string", "name",
                 "vertex_" + texture.word("name"));
    } else if (texture.type == "channel" && texture.textured("of", 0).texture) {
        w.out.approximated(texture.span, "`channel`", "Mitsuba takes the luminance of the picture");
        writeMitsubaTexture(parent, name, *texture.textured("of", 0).texture, true, w);
    } else {
        return leaveOutTexture(parent, name, texture, w); // with all that it states
    }
    w.out.leaveOutUnused(texture);
}

} // namespace abbe::exchange
