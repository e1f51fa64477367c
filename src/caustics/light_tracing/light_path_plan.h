// How paths of light take part in a render.
#pragma once

#include "caustics/shared/aimed_emission.h"

namespace abbe {

// Frozen before light is gathered.
struct LightPathPlan {
    AimedEmission emission;
    // Light paths for each sample of all pixels of the frame; > 0.
    std::uint32_t paths = 0;
    // What light paths can find is left to them alone; else the two ways are weighed by the balance heuristic.
    bool alone = false;
    // Of light paths that have been spread for the first time, by a matte lobe or in a medium, those that go on; (0,
    // 1].
    float afterSpread = 1;
};

} // namespace abbe
