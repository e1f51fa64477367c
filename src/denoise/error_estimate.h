// How wrong a denoised picture is, from its two halves.
#pragma once

#include "denoise/half_buffers.h"

namespace abbe {

// Each half of a picture after denoising.
using DenoisedHalves = std::array<ColourPlanes, 2>;

// For every pixel and channel an estimate without bias of the squared error of the mean of both halves, as long as what
// was made of one half is independent of the other [Bitterli2016, §5.3]. With A, B the noisy halves, D_A, D_B the
// denoised ones and µ the truth: (D_A − B)² − Var B expects (D_A − µ)², likewise with A and B exchanged, and
//   ((D_A + D_B)/2 − µ)² = ((D_A − µ)² + (D_B − µ)²)/2 − (D_A − D_B)²/4.
// Single values are as noisy as the picture, and may be negative. Borders are extended.
ColourPlanes squaredError(const HalfBuffers& noisy, const DenoisedHalves& denoised);

// (D_A − D_B)²/4, the part of the error that is noise, mean over the channels. Borders are extended.
Plane remainingNoise(const DenoisedHalves& denoised);

} // namespace abbe
