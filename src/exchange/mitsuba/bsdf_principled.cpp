#include "exchange/mitsuba/bsdfs.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

void leaveOutLobe(SceneNode& at, const XmlObject& bsdf, std::string_view param, std::string_view why,
                  MitsubaContext& ctx) {
    const XmlParam* const found = bsdf.find(param);
    if (!found || (found->numbers.size() == 1 && found->numbers[0] == 0)) return;
    ctx.import.leftOut(&at, found->span, fmt::format("`{}` of `{}`", param, bsdf.plugin), why);
}

// eta, or specular = ((eta − 1)/(eta + 1))² / 0.08 [Burley2012].
double principledIndex(const XmlObject& bsdf, MitsubaContext& ctx) {
    if (bsdf.has("eta")) return std::clamp(mitsubaNumber(bsdf, "eta", 1.5, ctx.import), 1.001, 4.0);
    const double specular = std::clamp(mitsubaNumber(bsdf, "specular", 0.5, ctx.import), 0.0, 12.0);
    const double root = std::sqrt(0.08 * specular);
    return std::clamp(2 / (1 - root) - 1, 1.0, 4.0);
}

} // namespace

namespace {

// aspect = sqrt(1 − 0.9 anisotropic), alpha_v / alpha_u = aspect².
void writeGloss(SceneNode& at, const XmlObject& bsdf, MaterialTraits& traits, MitsubaContext& ctx) {
    writeNumber(at, "specular-roughness", bsdf, "roughness", 0.5, nullptr, traits, ctx);
    at.child("specular-ior").number(principledIndex(bsdf, ctx));
    if (!bsdf.has("anisotropic")) return;
    writeNumber(
        at, "specular-roughness-anisotropy", bsdf, "anisotropic", 0,
        [](double a) { return 0.9 * std::clamp(a, 0.0, 1.0); }, traits, ctx);
}

// Light that goes in and out again passes the surface twice, and is tinted by the colour once.
void writeSurfaceTint(SceneNode& at, const XmlObject& bsdf, MaterialTraits& traits, MitsubaContext& ctx) {
    const XmlParam* const color = bsdf.find("base_color");
    if (color && isTexture(*color)) {
        writeColor(at, "transmission-color", bsdf, "base_color", SpectrumUse::reflectance, 0.5, traits, ctx);
        ctx.import.approximated(&at, color->span, "a texture of `base_color` with `spec_trans`",
                                "its tint counts at each surface that light crosses");
        return;
    }
    auto tint = color ? readSpectrum(*color, SpectrumUse::reflectance, ctx) : MitsubaSpectrum{};
    if (!tint) return;
    const auto root = [](double v) { return std::sqrt(std::clamp(v, 0.0, 1.0)); };
    tint->value = color ? root(tint->value) : root(0.5);
    tint->rgb = {root(tint->rgb.x), root(tint->rgb.y), root(tint->rgb.z)};
    for (auto& row : tint->rows) row.second = root(row.second);
    writeSpectrum(at.child("transmission-color"), *tint, SpectrumUse::reflectance, bsdf.span, ctx);
}

// A matte sheet without gloss, whose `diff_trans` of 0 … 2 is twice the share that passes.
void writeThinMatte(SceneNode& at, const XmlObject& bsdf, MaterialTraits& traits, MitsubaContext& ctx) {
    at.word("openpbr").child("geometry-thin-walled").word("on");
    writeColor(at, "base-color", bsdf, "base_color", SpectrumUse::reflectance, 0.5, traits, ctx);
    at.child("specular-weight").number(0);
    if (bsdf.has("sheen")) writeNumber(at, "fuzz-weight", bsdf, "sheen", 0, nullptr, traits, ctx);
    if (!bsdf.has("diff_trans")) return;
    writeNumber(
        at, "subsurface-weight", bsdf, "diff_trans", 0, [](double t) { return std::clamp(t / 2, 0.0, 1.0); }, traits,
        ctx);
    writeColor(at, "subsurface-color", bsdf, "base_color", SpectrumUse::reflectance, 0.5, traits, ctx);
    at.child("subsurface-scatter-anisotropy").number(1);
}

// Only what passes has gloss.
void writeThin(SceneNode& at, const XmlObject& bsdf, MaterialTraits& traits, MitsubaContext& ctx) {
    const XmlParam* const passes = bsdf.find("spec_trans");
    const bool plain = !passes || passes->numbers.size() == 1;
    const double share = passes && plain ? passes->numbers[0] : 0;
    if (plain && share <= 0) return writeThinMatte(at, bsdf, traits, ctx);
    const auto glass = [&](SceneNode& to) {
        to.word("openpbr").child("geometry-thin-walled").word("on");
        to.child("transmission-weight").number(1);
        writeColor(to, "transmission-color", bsdf, "base_color", SpectrumUse::reflectance, 0.5, traits, ctx);
        writeGloss(to, bsdf, traits, ctx);
    };
    if (plain && share >= 1) return glass(at);
    at.word("mix");
    writeThinMatte(at.child("first"), bsdf, traits, ctx);
    glass(at.child("second"));
    writeNumber(at, "amount", bsdf, "spec_trans", 0, nullptr, traits, ctx);
}

void writeSolid(SceneNode& at, const XmlObject& bsdf, MaterialTraits& traits, MitsubaContext& ctx) {
    at.word("openpbr");
    writeColor(at, "base-color", bsdf, "base_color", SpectrumUse::reflectance, 0.5, traits, ctx);
    writeGloss(at, bsdf, traits, ctx);
    const auto number = [&](const char* property, const char* param) {
        if (bsdf.has(param)) writeNumber(at, property, bsdf, param, 0, nullptr, traits, ctx);
    };
    number("base-metalness", "metallic");
    number("transmission-weight", "spec_trans");
    if (bsdf.has("spec_trans")) writeSurfaceTint(at, bsdf, traits, ctx);
    number("fuzz-weight", "sheen");
    number("coat-weight", "clearcoat");
    // Its highlight is that of alpha = 0.1 … 0.001 [Burley2012].
    if (bsdf.has("clearcoat_gloss"))
        writeNumber(
            at, "coat-roughness", bsdf, "clearcoat_gloss", 0,
            [](double gloss) { return std::sqrt(0.1 + (0.001 - 0.1) * std::clamp(gloss, 0.0, 1.0)); }, traits, ctx);
}

} // namespace

void writePrincipled(SceneNode& at, const XmlObject& bsdf, bool thin, MaterialTraits& traits, MitsubaContext& ctx) {
    (thin ? writeThin : writeSolid)(at, bsdf, traits, ctx);
    ctx.import.approximated(
        &at, bsdf.span, fmt::format("`{}`", bsdf.plugin),
        "OpenPBR has the same lobes in another order, and keeps the light that rough surfaces lose");
    leaveOutLobe(at, bsdf, "flatness", "it approximates scattering under the surface", ctx);
    leaveOutLobe(at, bsdf, "spec_tint", "the gloss is white", ctx);
    leaveOutLobe(at, bsdf, "sheen_tint", "fuzz is white", ctx);
    // Of a lobe that has no weight.
    mitsubaIgnore(bsdf, {"roughness", "anisotropic", "eta"});
    mitsubaIgnore(bsdf, {"diffuse_reflectance_sampling_rate", "specular_sampling_rate", "clearcoat_sampling_rate",
                         "main_specular", "specular_reflectance_sampling_rate", "diffuse_transmittance_sampling_rate",
                         "specular_transmittance_sampling_rate", "diff_refl_sampling_rate", "diff_trans_sampling_rate",
                         "spec_refl_sampling_rate", "spec_trans_sampling_rate"});
    traits.oneSided = !thin && !bsdf.has("spec_trans");
    traits.clear = bsdf.has("spec_trans") && !thin;
}

void writeHair(SceneNode& at, const XmlObject& bsdf, MitsubaContext& ctx) {
    at.word("hair");
    const auto number = [&](const char* property, const char* param, double otherwise, double most) {
        at.child(property).number(std::clamp(mitsubaNumber(bsdf, param, otherwise, ctx.import), 0.0, most));
    };
    const double scale = mitsubaNumber(bsdf, "scale", 1, ctx.import);
    if (const XmlParam* const sigma = bsdf.find("sigma_a")) {
        if (isTexture(*sigma))
            ctx.import.leftOut(&at, sigma->span, "a texture of `sigma_a`", "a fibre is as dark from root to tip");
        else if (const auto spectrum = readSpectrum(*sigma, SpectrumUse::positive, ctx))
            writeSpectrum(at.child("absorption"), scaled(*spectrum, scale), SpectrumUse::positive, sigma->span, ctx);
    } else { // brown, when nothing is said
        number("eumelanin", "eumelanin", 1.3, 100);
        number("pheomelanin", "pheomelanin", 0.2, 100);
        ctx.import.approximated(&at, bsdf.span, "`hair`", "the same model with other constants for pigments");
    }
    number("longitudinal-roughness", "longitudinal_roughness", 0.3, 1);
    number("azimuthal-roughness", "azimuthal_roughness", 0.3, 1);
    at.child("scale-angle")
        .number(std::clamp(mitsubaNumber(bsdf, "scale_tilt", 2, ctx.import), -28.0, 28.0))
        .word("deg");
    at.child("ior").number(std::clamp(relativeIndex(bsdf, 1.55, ctx), 1.05, 3.0));
    mitsubaIgnore(bsdf, {"use_pigmentation"});
}

} // namespace abbe::exchange
