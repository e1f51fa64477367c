#include "schema/definition_reader.h"
#include "schema/entry.h"
#include "schema/suggest.h"
#include "spectrum/color_space.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace abbe::schema {

namespace {

constexpr int kEdition = 1;

struct SpaceName {
    std::string_view name;
    RgbSpaceName id;
    const RgbSpace& space;
};

// Ids of the Color Interop Forum first, in the order of the enumeration, then the aliases.
constexpr auto kSpaces = std::to_array<SpaceName>({
    {"lin_rec709_scene", RgbSpaceName::linRec709, rgb::rec709},
    {"lin_rec2020_scene", RgbSpaceName::linRec2020, rgb::rec2020},
    {"lin_p3d65_scene", RgbSpaceName::linP3D65, rgb::p3d65},
    {"lin_ap1_scene", RgbSpaceName::linAp1, rgb::ap1},
    {"lin_ap0_scene", RgbSpaceName::linAp0, rgb::ap0},
    {"srgb-linear", RgbSpaceName::linRec709, rgb::rec709},
    {"rec709", RgbSpaceName::linRec709, rgb::rec709},
    {"rec2020", RgbSpaceName::linRec2020, rgb::rec2020},
    {"p3", RgbSpaceName::linP3D65, rgb::p3d65},
    {"acescg", RgbSpaceName::linAp1, rgb::ap1},
    {"aces2065-1", RgbSpaceName::linAp0, rgb::ap0},
});

void readEdition(const Node& node, Diagnostics& diagnostics) {
    if (node.valueCount() != 1 || node.value(0).kind != ValueKind::number) {
        report(diagnostics, node.headSpan(), "E0503", "`scene` needs the number of a language edition",
               "write `scene 1`");
        return;
    }
    const Value edition = node.value(0);
    if (edition.number == kEdition) return;
    report(diagnostics, place(edition), "E0501", fmt::format("this file needs language edition {}", edition.text),
           fmt::format("this version reads edition {}", kEdition));
}

void readLength(const Value& value, Header& header, Diagnostics& diagnostics) {
    const auto unit = value.isText() ? findUnit(value.text) : std::nullopt;
    if (unit && unit->dimension == Dimension::length) {
        header.length = unit->scale;
        return;
    }
    auto& d = report(diagnostics, place(value), "E0503", "`length` needs a unit of length",
                     unit ? fmt::format("this is {}", describe(unit->dimension)) : "not a unit");
    const std::array dimensions = {Dimension::length};
    const auto meant = suggestUnit(value.text, dimensions);
    d.help = meant.empty() ? "units of length are " + quotedList(spellings(Dimension::length)) : didYouMean(meant);
}

void readKey(const Key& key, Header& header, Diagnostics& diagnostics) {
    const Value& value = key.value;
    if (key.name == "length") return readLength(value, header, diagnostics);
    if (key.name == "rgb") {
        if (const auto space = readRgbSpace(value, diagnostics)) header.rgb = *space;
    } else if (key.name == "up") {
        header.zUp = value.text == "z";
        if (!value.isText() || (value.text != "y" && value.text != "z"))
            report(diagnostics, place(value), "E0503", "`up` must be `y` or `z`", fmt::format("is `{}`", value.text));
    } else if (key.name == "minor") {
        const bool whole =
            value.kind == ValueKind::number && value.number >= 0 && value.number == std::floor(value.number);
        if (!whole) report(diagnostics, place(value), "E0503", "`minor` must be a whole number");
    } else {
        const std::vector<std::string_view> known = {"length", "rgb", "up", "minor"};
        auto& d =
            report(diagnostics, key.nameSpan, "E0503", fmt::format("`scene` has no key `{}`", key.name), "unknown key");
        const auto meant = nearest(key.name, known);
        d.help = meant.empty() ? "its keys are " + quotedList(known) : didYouMean(meant);
    }
}

} // namespace

std::optional<RgbSpaceName> findRgbSpace(std::string_view idOrAlias) {
    const auto found = std::ranges::find(kSpaces, idOrAlias, &SpaceName::name);
    return found == kSpaces.end() ? std::nullopt : std::optional(found->id);
}

std::string_view rgbSpaceId(RgbSpaceName space) { return kSpaces[static_cast<std::size_t>(space)].name; }
const RgbSpace& rgbSpace(RgbSpaceName space) { return kSpaces[static_cast<std::size_t>(space)].space; }

std::vector<std::string_view> rgbSpaceWords() {
    std::vector<std::string_view> names;
    for (const SpaceName& s : kSpaces) names.push_back(s.name);
    return names;
}

std::string rgbSpaceList() { return quotedList(rgbSpaceWords()); }

std::optional<RgbSpaceName> readRgbSpace(const Value& value, Diagnostics& diagnostics) {
    if (value.isText())
        if (const auto space = findRgbSpace(value.text)) return space;
    auto& d = report(diagnostics, place(value), "E0315", fmt::format("unknown colour space `{}`", value.text),
                     "not a linear RGB space");
    if (value.text.starts_with("srgb")) {
        d.help = "encoded sRGB values are written `srgb \"#d87040\"`; linear ones have `space=srgb-linear`";
        return std::nullopt;
    }
    std::vector<std::string_view> names;
    for (const SpaceName& s : kSpaces) names.push_back(s.name);
    const auto meant = nearest(value.text, names);
    d.help = meant.empty() ? "the spaces are " + rgbSpaceList() : didYouMean(meant);
    return std::nullopt;
}

Header readHeader(const Document& document, Diagnostics& diagnostics) {
    Header header;
    std::optional<Span> first;
    bool atStart = true;
    for (const Node node : document.roots()) {
        if (isHeader(node)) {
            if (first || !atStart) {
                auto& d = report(diagnostics, node.headSpan(), "E0502",
                                 first ? "a file has one `scene` line" : "`scene` must be the first line of a file");
                if (first) d.related.push_back({*first, "the first one is here"});
            }
            if (!first) {
                first = header.span = node.headSpan();
                readEdition(node, diagnostics);
                for (const Key& key : node.keys()) readKey(key, header, diagnostics);
                if (node.hasBlock())
                    report(diagnostics, node.headSpan(), "E0503", "`scene` is one line and has no block",
                           "write the definitions below it");
            }
        }
        atStart = false;
    }
    if (!first) {
        const Span start{document.file, 0, 0};
        auto& d = diagnostics.warning("W0501", start, "the file does not name its language edition",
                                      fmt::format("read as edition {}", kEdition));
        d.help = fmt::format("write `scene {}` in the first line", kEdition);
        d.fixes.push_back({start, fmt::format("scene {}\n", kEdition)});
    }
    return header;
}

} // namespace abbe::schema
