// First-order regression of colours on features, the core of the denoiser.
#pragma once

#include "denoise/patch_weights.h"

#include <array>
#include <vector>

namespace abbe {

inline constexpr int kMaxFeatures = 7;

// Around every pixel p, over 19 × 19 pixels q, colours are fitted by an affine function of the features,
//   Σ_q w_pq |c_q − a − B·(f_q − f_p)|² → min,
// with the weights of the guide. Every fit predicts all pixels of its
// window, and a pixel's value is the mean of its predictions with the same weights [Bitterli2016, §4.2, §5.2].
// Two results, one for each bandwidth of the weights: k = 2, and k = 0.35, which keeps more detail and more noise.
//
// Features beyond what differs in the window (constant, or affine in those before) are left out of a fit; features are
// in units of which a thousandth does not matter. Without features this is NL-means. Requires at most kMaxFeatures
// features, and extended borders. Borders of the results are extended.
std::array<ColourPlanes, 2> regress(const std::vector<Plane>& colours, const std::vector<Plane>& features,
                                    const Guide& guide);

} // namespace abbe
