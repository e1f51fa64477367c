// First-order regression of colours on features, the core of the denoiser.
#pragma once

#include "denoise/half_buffers.h"

#include <array>
#include <vector>

namespace abbe {

inline constexpr int kMaxFeatures = 7;

// What colours are divided by before a fit, so that it is the light on a surface that is fitted, and what predictions
// are multiplied by: the albedo, and 1 in the place of a share `fade` of it. All of a fit is divided with the fade of
// its centre, so that a fade that changes from place to place adds no slopes.
struct Modulation {
    ColourPlanes albedo; // > 0
    Plane fade;          // 0 … 1
};

// Around every pixel p, over 19 × 19 pixels q, colours are fitted by an affine function of the features,
//   Σ_q w_pq |c_q/m_pq − a − B·(f_q − f_p)|² → min, m_pq = albedo_q + fade_p (1 − albedo_q),
// with the weights of the guide. Every fit predicts all pixels of its
// window, and a pixel's value is the mean of its predictions with the same weights [Bitterli2016, §4.2, §5.2].
// Two results, one for each bandwidth of the weights: k = 2, and one that keeps more detail and more noise, from their
// 2^narrowing-th power.
//
// Features beyond what differs in the window (constant, or affine in those before) are left out of a fit; features are
// in units of which a thousandth does not matter. Without features this is NL-means. Requires at most kMaxFeatures
// features, and extended borders. Borders of the results are extended.
std::array<ColourPlanes, 2> regress(const std::vector<Plane>& colours, const Modulation& modulation,
                                    const std::vector<Plane>& features, const Guide& guide, int narrowing);

} // namespace abbe
