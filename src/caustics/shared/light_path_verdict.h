// Whether a scene and the choices of `render` have light paths at all: the other techniques for caustics need them to
// be possible, too.
#pragma once

#include "render/technique.h"

#include <cstddef>
#include <cstdint>

namespace abbe {

struct Scene;

// What has been decided on light paths, and why. All but `used` and `requested` mean that there are none.
enum class LightPathVerdict : std::uint8_t {
    undecided,      // nobody looked, or the look was cut short
    used,           // forecast to pay
    requested,      // whatever is forecast: `light-paths always` or `alone`
    off,            // `light-paths off`
    otherTechnique, // another choice of `render` is at odds with them
    hiddenShapes,   // shadows and reflections see different shapes, which light paths cannot tell apart
    noLights,       // no light can start paths
    nothingFocuses, // no shape focuses light
    nothingFound,   // what light paths could bring has next to no noise in camera paths
    noGain,         // forecast to cost more than they bring
    noPilot,        // no pilot was sent, or there is no time for a first pass with what one found
};

// What scene and technique decide without a look: `undecided` leaves it to pilots.
LightPathVerdict lightPathVerdict(const Scene&, const Technique&);
// Blocks of light paths in a RenderState: 0 where none will be planned.
std::size_t lightBlocksOf(const Scene&, const Technique&);

} // namespace abbe
