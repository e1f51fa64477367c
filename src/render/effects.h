// The optional effects of light transport: computed from the scene, never asked of the user.
#pragma once

#include "base/flags.h"
#include "base/source.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace abbe {

// The first eight bits change the type or shape of the path loop, which exists once for each set of them. Everything
// else lives inside one material, camera or geometry and costs nothing when absent (docs/architecture.md, "Where
// optional effects live").
enum class Effect : std::uint32_t {
    absorption = 1,  // light is absorbed along segments inside a dielectric
    dispersion = 2,  // sampling densities depend on wavelength: spectral MIS and the end of secondary wavelengths
    media = 4,       // light is scattered between surfaces
    textures = 8,    // paths have a width, over which textures are averaged
    interfaces = 16, // surfaces that are partly open, or dielectrics that lie in one another
    lightPaths = 32, // paths that start at the lights, beside those from the camera; nothing a scene asks for, but
                     // what a plan may find worth its time (caustics/light_tracing/light_path_plan.h)

    subsurface = 1u << 8,    // a medium fills a shape
    glow = 1u << 9,          // media give off light
    bumps = 1u << 10,        // textures bend shading normals
    thinFilm = 1u << 11,     // light interferes in a film on a surface
    motion = 1u << 12,       // something changes while the shutter is open
    depthOfField = 1u << 13, // the lens has a width
    displacement = 1u << 14, // textures move surfaces
    subdivision = 1u << 15,  // surfaces are limits of cages
    curves = 1u << 16,       // shapes are strands
};
using Effects = Flags<Effect>;

inline constexpr Effects kLoopEffects =
    Effects(Effect::absorption) | Effect::dispersion | Effect::media | Effect::textures | Effect::interfaces;

// What this build can simulate of them: all, but for builds that show what a kernel without an effect saves (CMake
// option ABBE_WITHOUT, tests/compiled_out.sh).
#ifdef ABBE_WITHOUT_EFFECTS
inline constexpr Effects kCompiledEffects =
    Effects::fromBits(kLoopEffects.bits() & ~static_cast<std::uint32_t>(ABBE_WITHOUT_EFFECTS));
#else
inline constexpr Effects kCompiledEffects = kLoopEffects;
#endif
constexpr bool isCompiled(Effect loopEffect) { return kCompiledEffects.has(loopEffect); }

struct EffectInfo {
    Effect effect;
    std::string_view word;   // in `forbid`, in headers and in the names of kernels
    std::string_view title;  // for people
    std::string_view absent; // why a scene without it has none
};

// In the order of their bits.
inline constexpr std::array kEffectTable{
    EffectInfo{Effect::absorption, "absorption", "absorption inside solids", "no dielectric has an absorption"},
    EffectInfo{Effect::dispersion, "dispersion", "dispersion",
               "no refractive index and no extinction varies with wavelength"},
    EffectInfo{Effect::media, "media", "scattering in media", "no volume and no interior of a shape"},
    EffectInfo{Effect::textures, "textures", "footprints of paths", "no material and no light looks at a texture"},
    EffectInfo{Effect::interfaces, "interfaces", "open and nested surfaces",
               "no surface is partly open, no dielectrics may overlap"},
    EffectInfo{Effect::subsurface, "subsurface", "media inside shapes", "no medium fills a shape"},
    EffectInfo{Effect::glow, "glow", "light of media", "no medium has a temperature or an emission"},
    EffectInfo{Effect::bumps, "bumps", "bump and normal maps", "no material wears one"},
    EffectInfo{Effect::thinFilm, "thin-film", "interference in thin films", "no material has a thin film"},
    EffectInfo{Effect::motion, "motion", "motion blur", "nothing moves while the shutter is open"},
    EffectInfo{Effect::depthOfField, "depth-of-field", "depth of field", "the camera has no aperture"},
    EffectInfo{Effect::displacement, "displacement", "displacement", "no shape has a displacement"},
    EffectInfo{Effect::subdivision, "subdivision", "subdivision surfaces", "no shape is a subdivision surface"},
    EffectInfo{Effect::curves, "curves", "curves", "no shape is made of curves"},
};

constexpr const EffectInfo& infoOf(Effect effect) {
    return *std::find_if(kEffectTable.begin(), kEffectTable.end(),
                         [&](const EffectInfo& info) { return info.effect == effect; });
}

// Who asked for an effect, for `abbe explain` and `forbid`.
struct EffectReason {
    Effect effect;
    Span place; // invalid: the scene as a whole
    std::string why;
};

} // namespace abbe
