// Removes the noise of features (albedo, normal, depth) before they explain colours.
#pragma once

#include "denoise/half_buffers.h"

namespace abbe {

// NL-means over 11 × 11 pixels, each half with the weights of the other, and the mean of both [Bitterli2016, §5.1].
// The planes of one feature share their weights.
std::vector<Plane> filterFeature(const HalfBuffers& feature, float epsilon);

} // namespace abbe
