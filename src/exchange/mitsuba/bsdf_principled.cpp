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

void writePrincipled(SceneNode& at, const XmlObject& bsdf, bool thin, MaterialTraits& traits, MitsubaContext& ctx) {
    at.word("openpbr");
    ctx.import.approximated(
        &at, bsdf.span, fmt::format("`{}`", bsdf.plugin),
        "OpenPBR has the same lobes in another order, and keeps the light that rough surfaces lose");
    writeColor(at, "base-color", bsdf, "base_color", SpectrumUse::reflectance, 0.5, traits, ctx);
    writeNumber(at, "specular-roughness", bsdf, "roughness", 0.5, nullptr, traits, ctx);
    at.child("specular-ior").number(principledIndex(bsdf, ctx));
    const auto number = [&](const char* property, const char* param) {
        if (bsdf.has(param)) writeNumber(at, property, bsdf, param, 0, nullptr, traits, ctx);
    };
    number("base-metalness", "metallic");
    number("transmission-weight", "spec_trans");
    number("fuzz-weight", "sheen");
    number("coat-weight", "clearcoat");
    // Its highlight is that of alpha = 0.1 … 0.001 [Burley2012].
    if (bsdf.has("clearcoat_gloss"))
        writeNumber(
            at, "coat-roughness", bsdf, "clearcoat_gloss", 0,
            [](double gloss) { return std::sqrt(0.1 + (0.001 - 0.1) * std::clamp(gloss, 0.0, 1.0)); }, traits, ctx);
    // aspect = sqrt(1 − 0.9 anisotropic), alpha_v / alpha_u = aspect².
    if (bsdf.has("anisotropic"))
        writeNumber(
            at, "specular-roughness-anisotropy", bsdf, "anisotropic", 0,
            [](double a) { return 0.9 * std::clamp(a, 0.0, 1.0); }, traits, ctx);
    if (thin) {
        at.child("geometry-thin-walled").word("on");
        if (bsdf.has("diff_trans"))
            writeNumber(
                at, "subsurface-weight", bsdf, "diff_trans", 0, [](double t) { return std::clamp(t / 2, 0.0, 1.0); },
                traits, ctx);
    }
    leaveOutLobe(at, bsdf, "flatness", "it approximates scattering under the surface", ctx);
    leaveOutLobe(at, bsdf, "spec_tint", "the gloss is white", ctx);
    leaveOutLobe(at, bsdf, "sheen_tint", "fuzz is white", ctx);
    mitsubaIgnore(bsdf, {"diffuse_reflectance_sampling_rate", "specular_sampling_rate", "clearcoat_sampling_rate",
                         "main_specular", "diff_refl_sampling_rate", "diff_trans_sampling_rate",
                         "spec_refl_sampling_rate", "spec_trans_sampling_rate"});
    traits.oneSided = !thin && !bsdf.has("spec_trans");
    traits.clear = bsdf.has("spec_trans") && !thin;
}

void writeHair(SceneNode& at, const XmlObject& bsdf, MitsubaContext& ctx) {
    at.word("hair");
    const auto number = [&](const char* property, const char* param, double otherwise) {
        if (bsdf.has(param)) at.child(property).number(mitsubaNumber(bsdf, param, otherwise, ctx.import));
    };
    number("eumelanin", "eumelanin", 0);
    number("pheomelanin", "pheomelanin", 0);
    if (const XmlParam* const sigma = bsdf.find("sigma_a"))
        if (const auto spectrum = readSpectrum(*sigma, SpectrumUse::positive, ctx))
            writeSpectrum(at.child("absorption"), *spectrum, SpectrumUse::positive, sigma->span, ctx);
    number("longitudinal-roughness", "longitudinal_roughness", 0.3);
    number("azimuthal-roughness", "azimuthal_roughness", 0.3);
    at.child("scale-angle").number(mitsubaNumber(bsdf, "scale_tilt", 2, ctx.import)).word("deg");
    at.child("ior").number(std::clamp(relativeIndex(bsdf, 1.55, ctx), 1.05, 3.0));
    mitsubaIgnore(bsdf, {"scale"});
    ctx.import.approximated(&at, bsdf.span, "`hair`", "the same model with other constants for pigments");
}

} // namespace abbe::exchange
