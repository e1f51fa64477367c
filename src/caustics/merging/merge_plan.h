// How light paths are merged with camera paths in a render.
#pragma once

#include "caustics/shared/aimed_emission.h"

#include <cmath>
#include <cstdint>
#include <unordered_set>

namespace abbe {

// Frozen before light is gathered. A round has `photons` light paths and a camera path through every pixel, which all
// have the same wavelengths and the same time.
//
// Which light that is: the camera path meets mirrors and clear glass alone, then, at least one of them behind it, a
// vertex that spreads light; the light path meets a mirror or clear glass first, and anything after it. What manifold
// sampling covers is left out. The path tracer leaves out exactly that: light of these lamps that it meets by way of a
// delta, behind such a vertex (MergingExclusion).
struct MergePlan {
    AimedEmission emission;
    std::unordered_set<const Light*> lights; // whose light is merged
    std::uint32_t photons = 0;               // > 0
    std::uint32_t every = 1;                 // samples of a replicate there are to a round
    float leastRadius = 0;                   // m, > 0: of a disk, where a path has no width at all

    // Radius of the disk over which the first round gathers, over that of a pixel's cone (RayCone), which is
    // a quarter of the distance between pixels.
    static constexpr float kRadius = 6;
    // Radii of single rounds, such that the noise of their mean and its bias both go to 0 [Knaus2011, sec. 4, with
    // α = 2/3]: the bias as rounds^(-1/3).
    static float radius(std::uint32_t round) { return kRadius * std::pow(static_cast<float>(round) + 1, -1.f / 6); }
};

} // namespace abbe
