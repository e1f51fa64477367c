// How photon merging takes part in a render: the plan, and what its pilot found.
#pragma once

#include "caustics/shared/aimed_emission.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <unordered_set>
#include <vector>

namespace abbe {

// How light paths are merged with camera paths. Frozen before light is gathered. A round has `photons` light paths and
// a camera path through every pixel, which all have the same wavelengths and the same time.
//
// Which light that is: the camera path hits mirrors and clear glass alone, then, at least one of them behind it, a
// vertex that spreads light; the light path hits a mirror or clear glass first, and anything after it. What manifold
// sampling covers is left out. The path tracer leaves out exactly that: what these lights send that it hits by way of
// a delta, behind such a vertex (MergingExclusion).
struct MergePlan {
    AimedEmission emission;
    std::unordered_set<const Light*> lights; // whose light is merged
    std::uint32_t photons = 0;               // > 0
    std::uint32_t every = 1;                 // samples of a replicate there are to a round
    float leastRadius = 0;                   // m, > 0: of a disk, where a path has no width at all
    // Camera paths of a round beside the first of a pixel, at most: where the first of a pixel near it finds the
    // luminance `bright` or more; fewer where it is less, none below a tenth of that.
    std::uint32_t more = 0;
    float bright = 0;

    std::uint32_t moreBeside(float luminance) const {
        if (!(luminance > 0.1f * bright)) return 0;
        return luminance < bright ? static_cast<std::uint32_t>(std::ceil(static_cast<float>(more) * luminance / bright))
                                  : more;
    }

    // Radius of the disk over which the first round gathers, over that of a pixel's cone (RayCone), which is
    // a quarter of the distance between pixels.
    static constexpr float kRadius = 6;
    // Radii of single rounds, such that the noise of their mean and its bias both go to 0 [Knaus2011, sec. 4, with
    // α = 2/3]: the bias as rounds^(-1/3).
    static float radius(std::uint32_t round) { return kRadius * std::pow(static_cast<float>(round) + 1, -1.f / 6); }
};

// What was found out about merging before a render, for people to read. It depends on the scene, the frame and the seed
// alone.
struct MergeFindings {
    bool measured = false; // a pilot has run: whether the numbers below mean anything
    bool used = false;
    bool found = false; // whether there is any such light
    // Of a sample of every pixel, in the mean over pixels: relative second moment of that light as camera paths find it
    // (infinite where they never do) and as merging does with `every`; relative variance of everything else; and what
    // all of that comes to in efficiency.
    double before = 0, after = 0, rest = 0, gain = 1;
    std::uint32_t every = 1;         // samples of a replicate there are to a round
    std::uint32_t photons = 0;       // light paths of a round
    std::uint32_t more = 0;          // camera paths of a round beside the first, where such light is seen
    std::uint64_t rays = 0;          // that it took to find out
    std::vector<std::string> lights; // whose light is merged
    std::vector<std::string> unseen; // whose light camera paths never find, whether it is merged or not
};

} // namespace abbe
