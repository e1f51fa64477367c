#include "exchange/mitsuba/bsdfs.h"
#include "schema/scene_tree.h"
#include "schema/suggest.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

struct NamedIndex {
    std::string_view name;
    double index;
};

// Refractive indices at the sodium D line that names stand for [Mitsuba 3 documentation, "Smooth dielectric material"].
constexpr NamedIndex kNamedIndices[] = {
    {"vacuum", 1.0},      {"helium", 1.00004},         {"hydrogen", 1.00013},
    {"air", 1.000277},    {"carbon dioxide", 1.00045}, {"water", 1.3330},
    {"acetone", 1.36},    {"ethanol", 1.361},          {"carbon tetrachloride", 1.461},
    {"glycerol", 1.4729}, {"benzene", 1.501},          {"silicone oil", 1.52045},
    {"bromine", 1.661},   {"water ice", 1.31},         {"fused quartz", 1.458},
    {"pyrex", 1.470},     {"acrylic glass", 1.49},     {"polypropylene", 1.49},
    {"bk7", 1.5046},      {"sodium chloride", 1.544},  {"amber", 1.55},
    {"pet", 1.5750},      {"diamond", 2.419},
};

double indexOf(const XmlObject& bsdf, std::string_view param, double otherwise, MitsubaContext& ctx) {
    const XmlParam* const found = bsdf.find(param);
    if (!found) return otherwise;
    if (found->numbers.size() == 1) return found->numbers[0];
    if (found->tag == "string") {
        std::string name(found->text);
        std::ranges::transform(name, name.begin(),
                               [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
        std::vector<std::string_view> names;
        for (const NamedIndex& known : kNamedIndices) {
            if (known.name == name) return known.index;
            names.push_back(known.name);
        }
        ctx.import.diagnostics.error("E0802", found->span, fmt::format("no material is called `{}`", found->text))
            .help = schema::didYouMean(schema::nearest(name, names));
        return otherwise;
    }
    ctx.import.approximated(nullptr, found->span, fmt::format("`{}`", param),
                            "an index that varies is that of its name's default");
    return otherwise;
}

// Mitsuba's presets that were measured for Abbe, too, by others.
constexpr std::pair<std::string_view, std::string_view> kMetals[] = {
    {"Ag", "Ag"},       {"Al", "Al"},   {"Au", "Au"}, {"Cr", "Cr"},       {"Cu", "Cu"},       {"Hg", "Hg"},
    {"Ni_palik", "Ni"}, {"TiN", "TiN"}, {"W", "W"},   {"Cu_palik", "Cu"}, {"Ag_palik", "Ag"}, {"Cr_palik", "Cr"},
};

void writeIndexPart(SceneNode& block, const char* name, const XmlObject& bsdf, std::string_view param, double otherwise,
                    double outside, MitsubaContext& ctx) {
    const XmlParam* const found = bsdf.find(param);
    SceneNode& part = block.child(name);
    std::optional<MitsubaSpectrum> spectrum;
    if (found) spectrum = readSpectrum(*found, SpectrumUse::positive, ctx);
    if (!spectrum) {
        part.number(otherwise);
        return;
    }
    // Tables of an index go on beyond their ends.
    if (spectrum->kind == MitsubaSpectrum::Kind::table)
        std::erase_if(spectrum->rows, [](const auto& row) { return row.second == 0; });
    writeSpectrum(part, scaled(*spectrum, 1 / outside), SpectrumUse::positive, found->span, ctx);
}

} // namespace

double relativeIndex(const XmlObject& bsdf, double defaultInside, MitsubaContext& ctx) {
    const double inside = indexOf(bsdf, "int_ior", defaultInside, ctx);
    const double outside = indexOf(bsdf, "ext_ior", 1.000277, ctx);
    if (!(inside > 0) || !(outside > 0)) {
        ctx.import.diagnostics.error("E0802", bsdf.span, "a refractive index is above 0");
        return 1.5;
    }
    return std::clamp(inside / outside, 0.2, 10.0);
}

void writeMetalIndex(SceneNode& at, std::string property, const XmlObject& bsdf, MitsubaContext& ctx) {
    const XmlParam* const material = bsdf.find("material");
    const std::string_view name = material ? material->text : "none";
    const double outside = bsdf.has("ext_eta") ? indexOf(bsdf, "ext_eta", 1, ctx) : 1;
    SceneNode& index = at.child(std::move(property));
    if (!bsdf.has("eta") && name != "none") {
        const auto known =
            std::ranges::find(kMetals, std::string_view(name), &std::pair<std::string_view, std::string_view>::first);
        const bool found = known != std::end(kMetals);
        ctx.import.approximated(nullptr, material ? material->span : bsdf.span, fmt::format("metal `{}`", name),
                                found ? "by another measurement of the same metal"
                                      : "by chromium, since this one is not among the measured metals");
        index.word("metal").word(found ? known->second : "Cr");
        return;
    }
    // "none", and what states nothing, is a mirror: an index of 0 and 1 reflects all.
    writeIndexPart(index, "n", bsdf, "eta", 0, outside, ctx);
    writeIndexPart(index, "k", bsdf, "k", 1, outside, ctx);
}

} // namespace abbe::exchange
