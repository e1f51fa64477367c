// What the parameters of an OpenPBR surface cannot be together.
#include "materials/openpbr.h"
#include "render/texture.h"

#include <cmath>

namespace abbe {
namespace {

constexpr double kMostAnisotropic = 0.99; // as in `material subsurface`

}

bool checkParams(const OpenPbrParams& p, const schema::PlaceOf& placeOf, Diagnostics& diagnostics) {
    const std::size_t before = diagnostics.errorCount();
    const auto error = [&](const char* code, std::string_view property, const char* message, const char* label,
                           const char* help) {
        diagnostics.error(code, placeOf(property), message, label).help = help;
    };
    const bool filled = hasSubsurfaceInside(p);
    if (filled && (p.transmissionWeight.texture || p.transmissionWeight.value > 0))
        error("E0700", "transmission-weight", "a solid is filled with two things",
              "glass, and the medium of `subsurface-weight`",
              "leave one of the weights out; milky glass is `transmission-weight 1` with `transmission-scatter`");
    if (filled && std::abs(p.subsurfaceScatterAnisotropy) > kMostAnisotropic)
        error("E0703", "subsurface-scatter-anisotropy", "light is never turned aside",
              "in a solid, this lies between -0.99 and 0.99", "0.9 is strongly forward");
    if (p.transmissionDispersionScale > 0 && p.specularIor && !p.specularIor->isConstant())
        error("E0701", "transmission-dispersion-scale", "the dispersion is stated twice",
              "`specular-ior` varies with wavelength already", "leave one of them out");
    if (!p.geometryThinWalled && p.transmissionDepth > 0 && p.transmissionColor.texture)
        error("E0702", "transmission-color", "the colour of an inside cannot be a texture",
              "`transmission-depth` is above 0",
              "leave `transmission-depth` out to tint at the surface, or give one colour");
    if (filled && p.subsurfaceColor.texture)
        error("E0702", "subsurface-color", "the colour of an inside cannot be a texture",
              "light that enters here comes out elsewhere",
              "give one colour; `subsurface-weight` and `base-color` may be textures");
    for (const auto& [property, directions] : {std::pair("geometry-tangent", p.geometryTangent.texture),
                                               std::pair("geometry-coat-normal", p.geometryCoatNormal.texture),
                                               std::pair("geometry-coat-tangent", p.geometryCoatTangent.texture)})
        if (directions && directions->channels() < 3)
            error("E0705", property, "directions have three channels", "this texture has one",
                  "take an image of directions, 0 … 1 for -1 … 1, or give a number");
    const bool stretched = p.specularRoughnessAnisotropy.texture || p.specularRoughnessAnisotropy.value > 0;
    const bool varies = p.specularRoughness.texture || p.specularRoughnessAnisotropy.texture || p.coatWeight.texture ||
                        p.coatRoughness.texture;
    if (mayRefract(p) && stretched && varies)
        error("E0704", "specular-roughness-anisotropy", "stretched rough glass cannot vary by a texture",
              "what it scatters more than once is tabulated for one roughness and one anisotropy",
              "give plain numbers, or leave the anisotropy out where the surface transmits");
    const bool coated = p.coatWeight.texture || p.coatWeight.value > 0,
               fuzzy = p.fuzzWeight.texture || p.fuzzWeight.value > 0;
    for (const auto& [property, varying] : {std::pair("coat-weight", p.coatWeight.texture && tints(p.coatColor)),
                                            std::pair("coat-color", coated && p.coatColor.texture),
                                            std::pair("coat-ior", coated && tints(p.coatColor) && p.coatIor.texture),
                                            std::pair("fuzz-weight", p.fuzzWeight.texture != nullptr),
                                            std::pair("fuzz-roughness", fuzzy && p.fuzzRoughness.texture)})
        if (varying && p.emissionLuminance > 0)
            error("E0706", property, "light from below a cover that varies by a texture",
                  "the surface shines: `emission-luminance` is above 0",
                  "give one value here, or let `emission-color` vary instead");
    return diagnostics.errorCount() == before;
}

} // namespace abbe
