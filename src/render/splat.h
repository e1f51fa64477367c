// Light that paths from the lights bring to a pixel.
#pragma once

#include "render/path_component.h"
#include "spectrum/spectrum.h"
#include "spectrum/xyz.h"

#include <cstddef>
#include <cstdint>

namespace abbe {

// Who brings it: a light path that the lens sees, or a round of merging, in which light paths are gathered where camera
// paths end (caustics/merging/merge_kernel.h). Each kind is counted, and averaged, by itself.
enum class SplatKind : std::uint8_t { lightPath, merged };
inline constexpr std::size_t kSplatKinds = 2;

// What is added to one pixel, for the time of the call. The sum of a pixel's splats over the number of light paths, or
// of rounds, tends to the pixel's radiance: the number of pixels of the frame and the filter are in it.
struct Splat {
    Xyz value; // finite, each component below ExactSum::kLargest
    // The same before the sensor, for spectral layers: value = sensor(radiance, lambda) · factor.
    const Spectrum& radiance;
    const Wavelengths& lambda;
    double factor;
    const void* light; // where the path began, for light groups
    PathComponent component;
    SplatKind kind = SplatKind::lightPath;
    double closer = 0; // of merged light: its Y if it had been gathered over half of the area, which tells its bias
};

} // namespace abbe
