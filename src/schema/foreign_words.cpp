#include "schema/foreign_words.h"

#include "schema/entry.h"
#include "schema/measure.h"
#include "schema/suggest.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <fmt/format.h>

namespace abbe::schema {

namespace {

// Words whose values mean the same here. Bare numbers do not where other programs count in
// another unit than metres.
constexpr auto kSame = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"Kd", "reflectance"},
    {"albedo", "reflectance"},
    {"diffuse_color", "reflectance"},
    {"base_color", "reflectance"},
    {"color", "reflectance"},
    {"colour", "reflectance"},
    {"colour", "color"},
    {"eta", "ior"},
    {"int_ior", "ior"},
    {"spp", "samples"},
    {"pixelsamples", "samples"},
    {"sample_count", "samples"},
    {"filename", "file"},
    {"path", "file"},
    {"filename", "image"},
    {"r", "radius"},
    {"focal-length", "lens"},
    {"fstop", "f-stop"},
    {"f-number", "f-stop"},
    {"fnumber", "f-stop"},
    {"position", "from"},
    {"eye", "from"},
    {"target", "look-at"},
    {"focus-distance", "focus"},
    {"focal-distance", "focus"},
    {"focaldistance", "focus"},
    {"exposure-time", "shutter"},
    {"metalness", "base-metalness"},
    {"metallic", "base-metalness"},
    {"attenuation-depth", "attenuation-distance"},
    {"transmission_depth", "attenuation-distance"},
});

// Words whose values are calculated.
struct Formula {
    std::string_view word, field;
    double (*of)(double);
    std::string_view reason, unit;
};
double squareRoot(double x) { return std::sqrt(x); }
double oneMinus(double x) { return 1 - x; }
double toStops(double x) { return std::log2(x); }
double unchanged(double x) { return x; }
double toNits(double x) { return 72983 * x; } // nits of a pixel of an environment that renders as 1
constexpr auto kFormulas = std::to_array<Formula>({
    {"alpha", "roughness", squareRoot, "roughness is the square root of the width α", ""},
    {"alpha", "specular-roughness", squareRoot, "roughness is the square root of the width α", ""},
    {"glossiness", "roughness", oneMinus, "roughness is 1 − glossiness", ""},
    {"glossiness", "specular-roughness", oneMinus, "roughness is 1 − glossiness", ""},
    {"gain", "exposure", toStops, "each stop doubles, so it is the logarithm to base 2", "stops"},
    {"strength", "luminance", toNits, "a white pixel that is rendered as 1 has 72 983 nits", "nits"},
    {"intensity", "luminance", toNits, "a white pixel that is rendered as 1 has 72 983 nits", "nits"},
    {"scale", "luminance", toNits, "a white pixel that is rendered as 1 has 72 983 nits", "nits"},
    {"watts", "power", unchanged, "the unit stands behind the number", "W"},
    {"lumens", "power", unchanged, "the unit stands behind the number", "lm"},
    {"nits", "luminance", unchanged, "the unit stands behind the number", "nits"},
    {"candela", "intensity", unchanged, "the unit stands behind the number", "cd"},
    {"lux", "irradiance", unchanged, "the unit stands behind the number", "lx"},
    {"temperature", "color", unchanged, "the spectrum of a black body", "K"},
});

// Types of other programs.
struct TypeWord {
    std::string_view word;
    Kind kind;
    std::string_view type;
};
constexpr auto kTypes = std::to_array<TypeWord>({
    {"principled", Kind::material, "openpbr"},
    {"principled-bsdf", Kind::material, "openpbr"},
    {"disney", Kind::material, "openpbr"},
    {"standard-surface", Kind::material, "openpbr"},
    {"pbr", Kind::material, "openpbr"},
    {"uber", Kind::material, "openpbr"},
    {"plastic", Kind::material, "openpbr"},
    {"roughplastic", Kind::material, "openpbr"},
    {"coateddiffuse", Kind::material, "layered"},
    {"lambert", Kind::material, "diffuse"},
    {"lambertian", Kind::material, "diffuse"},
    {"matte", Kind::material, "diffuse"},
    {"glossy", Kind::material, "conductor"},
    {"metal", Kind::material, "conductor"},
    {"mirror", Kind::material, "conductor"},
    {"roughconductor", Kind::material, "conductor"},
    {"glass", Kind::material, "dielectric"},
    {"water", Kind::material, "dielectric"},
    {"refraction", Kind::material, "dielectric"},
    {"roughdielectric", Kind::material, "dielectric"},
    {"thindielectric", Kind::material, "thin-dielectric"},
    {"translucent", Kind::material, "diffuse-transmission"},
    {"velvet", Kind::material, "sheen"},
    {"cloth", Kind::material, "sheen"},
    {"sss", Kind::material, "subsurface"},
    {"skin", Kind::material, "subsurface"},
    {"area", Kind::light, "quad"},
    {"rect", Kind::light, "quad"},
    {"rectangle", Kind::light, "quad"},
    {"omni", Kind::light, "point"},
    {"directional", Kind::light, "sun"},
    {"distant", Kind::light, "sun"},
    {"infinite", Kind::light, "environment"},
    {"envmap", Kind::light, "environment"},
    {"dome", Kind::light, "environment"},
    {"hdri", Kind::light, "environment"},
    {"constant", Kind::light, "sky"},
    {"photometric", Kind::light, "ies"},
    {"cube", Kind::shape, "box"},
    {"rectangle", Kind::shape, "quad"},
    {"trianglemesh", Kind::shape, "mesh"},
    {"obj", Kind::shape, "mesh"},
    {"ply", Kind::shape, "mesh"},
    {"hair", Kind::shape, "curves"},
    {"pinhole", Kind::camera, "perspective"},
    {"thinlens", Kind::camera, "perspective"},
    {"ortho", Kind::camera, "orthographic"},
    {"bitmap", Kind::texture, "image"},
    {"imagemap", Kind::texture, "image"},
    {"checkerboard", Kind::texture, "checker"},
    {"perlin", Kind::texture, "noise"},
    {"fbm", Kind::texture, "noise"},
    {"hg", Kind::phase, "henyey-greenstein"},
});

// Without capitals and separators: "baseColor", "base_color" and "base-color" are one word.
std::string lettersOf(std::string_view word) {
    std::string letters;
    for (const char c : word)
        if (c != '-' && c != '_') letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return letters;
}

bool saysUnit(const Node& node) { return node.valueCount() > 1 && node.value(node.valueCount() - 1).isText(); }

// "`alpha 0.1` is `roughness 0.316`: roughness is the square root of the width α"
std::string calculated(const Formula& formula, const Node& node) {
    const bool number = node.valueCount() > 0 && node.value(0).kind == ValueKind::number;
    const double x = number ? formula.of(node.value(0).number) : std::nan("");
    if (!std::isfinite(x)) return {};
    const std::string value = plain(std::stod(fmt::format("{:.3g}", x)));
    const std::string_view form = formula.word == "temperature" ? "blackbody " : "";
    return fmt::format("`{}` is `{} {}{}{}{}`: {}", headText(node), formula.field, form, value,
                       formula.unit.empty() ? "" : " ", formula.unit, formula.reason);
}

} // namespace

bool isMisspelling(std::string_view word, std::string_view meant) {
    if (lettersOf(word) == lettersOf(meant)) return true;
    constexpr std::size_t kShortest = 4;
    const bool numbered = std::ranges::any_of(word, [](char c) { return c >= '0' && c <= '9'; });
    return !numbered && word.size() >= kShortest && meant.size() >= kShortest && editDistance(word, meant) == 1;
}

ForeignProperty translate(const TypeInfo& type, const FieldInfo& meant, const Node& written) {
    const std::string word = lettersOf(written.name());
    for (const Formula& formula : kFormulas)
        if (lettersOf(formula.word) == word && formula.field == meant.name)
            return {false, calculated(formula, written)};
    const bool known = std::ranges::any_of(kSame, [&](const auto& pair) {
        return pair.second == meant.name && isMisspelling(written.name(), pair.first);
    });
    if (known) return {meant.usualUnit.empty() || saysUnit(written), {}};
    const auto near = [&](const FieldInfo& field) { return isMisspelling(written.name(), field.name); };
    const bool synonym = std::ranges::any_of(meant.synonyms, [&](std::string_view s) { return lettersOf(s) == word; });
    if (near(meant) && (!synonym || lettersOf(meant.name) == word))
        return {std::ranges::count_if(type.fields, near) == 1, {}};
    if (!synonym) return {};
    return {false, fmt::format("did you mean {}? `{}` of other programs may be another quantity or have another unit",
                               fieldHint(meant), written.name())};
}

std::string adviceFor(const TypeInfo& type, std::string_view word) {
    constexpr auto shadows =
        std::to_array<std::string_view>({"shadow", "shadows", "castshadow", "castshadows", "useshadow", "visibleshadow",
                                         "receiveshadow", "shadowcatcher"});
    if (std::ranges::find(shadows, lettersOf(word)) == shadows.end()) return {};
    if (const FieldInfo* visible = type.find("visible-to")) return fmt::format("did you mean {}?", fieldHint(*visible));
    return "shadows are where light does not reach: every light and every shape casts them";
}

std::string adviceForControl(std::string_view word) {
    constexpr auto kWords =
        std::to_array<std::string_view>({"for", "foreach", "repeat", "loop", "while", "if", "else", "function", "def"});
    if (std::ranges::find(kWords, word) == kWords.end()) return {};
    return "many of a kind are `instances` (`grid`, `scatter`, or places from a file); numbers are computed in quotes, "
           "`\"$r * 2\"`; anything else is for a script that writes the scene, with the Python package `abbe` say";
}

std::string_view foreignType(const TypeTable& table, Kind kind, std::string_view word) {
    const std::string letters = lettersOf(word);
    for (const TypeWord& t : kTypes)
        if (t.kind == kind && lettersOf(t.word) == letters && table.find(kind, t.type)) return t.type;
    return {};
}

} // namespace abbe::schema
