// What paths come to beside light.
#pragma once

#include "caustics/manifold/manifold_sample.h"
#include "render/effect_counts.h"

#include <cstdint>

namespace abbe {

// What the paths of one tile counted.
struct PathCounters {
    std::uint64_t paths = 0, vertices = 0, shadowRays = 0, capped = 0;
    const void* cappedIn = nullptr; // the shape or the medium, of the last of them
    EffectCounts effects;
    ManifoldCounts manifold;
    // A path was left before its end, because the render is to end. Its rays are counted, but it is no sample.
    bool left = false;

    void add(const PathCounters& c) {
        paths += c.paths;
        vertices += c.vertices;
        shadowRays += c.shadowRays;
        capped += c.capped;
        if (c.cappedIn) cappedIn = c.cappedIn;
        effects.add(c.effects);
        manifold.add(c.manifold);
        left |= c.left;
    }
};

} // namespace abbe
