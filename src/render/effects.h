// The optional effects of light transport: computed from the scene, never asked of the user.
#pragma once

#include "base/flags.h"
#include "base/source.h"

#include <cstdint>
#include <string>

namespace abbe {

// Only effects that change the type or shape of the path loop have a bit here; everything else lives inside one
// material, camera or geometry and costs nothing when absent (docs/architecture.md, "Where effects live").
enum class Effect : std::uint8_t {
    absorption = 1,  // light is absorbed along segments inside a dielectric
    dispersion = 2,  // sampling densities depend on wavelength: spectral MIS and the end of secondary wavelengths
    media = 4,       // light is scattered between surfaces
    textures = 8,    // paths have a width, over which textures are averaged
    interfaces = 16, // surfaces that are partly open, or dielectrics that lie in one another
};
using Effects = Flags<Effect>;

inline constexpr Effects kAllEffects =
    Effects(Effect::absorption) | Effect::dispersion | Effect::media | Effect::textures | Effect::interfaces;

// Who asked for an effect, for `abbe explain` and the image header.
struct EffectReason {
    Effect effect;
    Span asker;
    std::string why;
};

} // namespace abbe
