// Which kinds of rays see a shape.
#pragma once

#include "base/flags.h"

#include <cstdint>

namespace abbe {

// Bits, so that they serve as masks of rays.
enum class RayKind : std::uint32_t {
    camera = 1,    // from the camera to what first scatters the light, through openings and boundaries
    shadow = 2,    // between a place and a light that is asked for
    scattered = 4, // all that have been scattered, and paths of light
};

using Visibility = Flags<RayKind>;

inline constexpr Visibility kVisibleToAll = Visibility(RayKind::camera) | RayKind::shadow | RayKind::scattered;

// Whether asking for lights and scattering meet the same things: shapes that differ here make light arrive otherwise
// by one than by the other, which weights between the two have to know.
constexpr bool seenAlike(Visibility v) { return v.has(RayKind::shadow) == v.has(RayKind::scattered); }

} // namespace abbe
