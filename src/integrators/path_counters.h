// What paths come to beside light.
#pragma once

#include "integrators/manifold_sample.h"
#include "render/effect_counts.h"

#include <cstdint>

namespace abbe {

// What the paths of one tile counted.
struct PathCounters {
    std::uint64_t paths = 0, vertices = 0, shadowRays = 0, capped = 0;
    EffectCounts effects;
    ManifoldCounts manifold;

    void add(const PathCounters& c) {
        paths += c.paths;
        vertices += c.vertices;
        shadowRays += c.shadowRays;
        capped += c.capped;
        effects.add(c.effects);
        manifold.add(c.manifold);
    }
};

} // namespace abbe
