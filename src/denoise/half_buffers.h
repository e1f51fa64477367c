// A noisy picture as two independent halves.
#pragma once

#include "denoise/patch_weights.h"

#include <array>
#include <vector>

namespace abbe {

// Planes that belong together (R G B, or the components of a normal) from two halves of the samples, and the variance
// of each half, averaged over (2·radius + 1)² pixels: few enough to follow the noise, and enough that a single pixel of
// one half hardly takes part in what is made of the other. Borders are extended.
struct HalfBuffers {
    std::array<std::vector<Plane>, 2> halves;
    std::vector<Plane> variances;

    HalfBuffers(std::vector<Plane> first, std::vector<Plane> second, int radius);
    // One half and the variances, for weights; `epsilon` as in Guide.
    Guide guide(std::size_t half, float epsilon) const;
};

Guide guideOf(const std::vector<Plane>& values, const std::vector<Plane>& variances, float epsilon);

// The brightness at which compressed() turns from linear to logarithmic, where that of most pixels is near kTypical.
inline constexpr float kDark = 0.02f, kTypical = 0.2f;

// asinh(c/kDark): the noise of a path tracer goes with the light, and after this it is much alike in bright and dark
// places, so that neither seems noisy because of the other. Borders are extended.
std::vector<Plane> compressed(const std::vector<Plane>& colours);

} // namespace abbe
