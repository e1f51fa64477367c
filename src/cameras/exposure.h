// How radiance becomes pixel values.
#pragma once

#include <cmath>

namespace abbe {

// At 0 stops and a sensitivity of 1 a pixel of Y = 1 stands for 72 983 nits (docs/conventions.md).
struct Exposure {
    double sensitivity = 1; // pixel value per unit of radiance at 0 stops
    double stops = 0;       // of the camera's `exposure`; 0 while an automatic one is not known
    bool automatic = false; // `exposure auto`: a look at the scene finds the stops

    double factor() const { return std::exp2(stops) * sensitivity; }
};

} // namespace abbe
