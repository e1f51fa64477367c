// Which kinds of rays see a shape.
#pragma once

#include "base/flags.h"
#include "math/vec.h"

#include <cstddef>
#include <cstdint>

namespace abbe {

// Bits, so that they serve as masks of rays.
enum class RayKind : std::uint32_t {
    camera = 1,    // from the camera to what first scatters the light, through openings and boundaries
    shadow = 2,    // between a place and a light that it samples
    scattered = 4, // all that have been scattered, and paths of light
};

inline constexpr std::size_t kRayKinds = 3;

using Visibility = Flags<RayKind>;

inline constexpr Visibility kVisibleToAll = Visibility(RayKind::camera) | RayKind::shadow | RayKind::scattered;

// Whether next-event estimation and scattering hit the same things: shapes that differ here make light arrive
// otherwise by one than by the other, which weights between the two have to know.
constexpr bool seenAlike(Visibility v) { return v.has(RayKind::shadow) == v.has(RayKind::scattered); }

// Render space. `direction` is of unit length; `time` in [0, 1] of the shutter interval.
struct Ray {
    Vec3 origin;
    Vec3 direction;
    float tMax = kInfinity;
    float time = 0;
    RayKind kind = RayKind::scattered; // shapes that it does not see are not there
};

// A part of a ray.
struct RayExtent {
    float tNear = 0, tFar = 0;
    bool empty() const { return !(tNear < tFar); }
};

} // namespace abbe
