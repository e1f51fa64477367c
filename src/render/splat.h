// Light that a path from a light brings to a pixel.
#pragma once

#include "render/path_component.h"
#include "spectrum/wavelengths.h"
#include "spectrum/xyz.h"

namespace abbe {

// What a light path adds to one pixel, for the time of the call. The sum of a pixel's splats over the number of light
// paths tends to the pixel's radiance: the number of pixels of the frame and the filter are in it.
struct Splat {
    Xyz value; // finite, each component below ExactSum::kLargest
    // The same before the sensor, for spectral layers: value = sensor(radiance, lambda) · factor.
    const Spectrum& radiance;
    const Wavelengths& lambda;
    double factor;
    const void* light; // where the path began, for light groups
    PathComponent component;
};

} // namespace abbe
