// How flux is spread over a disk.
#pragma once

#include "math/vec.h"

namespace abbe {

// The kernel of [Epanechnikov1969] in the plane: 2/(π r²) (1 − d²/r²).
struct DiskKernel {
    float value;  // 1/m²
    float closer; // over that: what the same kernel has over half of the area

    // `x`: square of the distance over the radius, in [0, 1).
    DiskKernel(float x, float radius)
        : value(2 * (1 - x) / (kPi * radius * radius)), closer(x < 0.5f ? 2 * (1 - 2 * x) / (1 - x) : 0) {}
};

} // namespace abbe
