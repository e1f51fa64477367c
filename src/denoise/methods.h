// The methods of denoising: a fast preview by five levels of wavelets with holes, and the denoiser for final pictures,
// which mixes one picture from several denoised ones, by what their two halves say about their errors.
#pragma once

#include "denoise/half_buffers.h"
#include "denoise/prepared_input.h"

#include <vector>

namespace abbe {

struct Mixture {
    DenoisedHalves picture;
    // What the errors are to be estimated from: the same mixture with weights that know nothing of the pixel's own
    // noise. Of candidates that differ by chance those win whose noise happens to look good, so that an estimate from
    // the pixels that made the choice is too small.
    DenoisedHalves validated;
};

// Aggregation with exponential weights [Dalalyan2008]: at each pixel a candidate has the weight exp(−t), t how far its
// estimated error lies above the least one, in units of what such a difference is uncertain by. Errors are relative to
// the brightness and averaged over 11 × 11 pixels; candidates that cannot be told apart are averaged. Weights are
// blurred, so that they leave no edges. `validated` has at the black squares of a chessboard of pixels the weights that
// the white ones give, and the other way round. Requires a candidate. Borders are extended.
Mixture mix(const HalfBuffers& noisy, const std::vector<DenoisedHalves>& candidates);

// Each half by the edge-avoiding wavelets of [Dammertz2010]; differences of its own colours count in units of the
// noise, which shrinks from level to level [Schied2017]. Weights from the other half leave less noise, but then it
// cannot tell any more how large the error is.
DenoisedHalves denoiseByWavelets(const PreparedInput&);

// Each half by regression on features with NL-means weights [Bitterli2016], twice: first with weights from the noisy
// half itself, then with weights from what became of it, as in [Dabov2007]. All results, those of the wavelets and the
// half as it is are candidates of mix().
Mixture denoiseByRegression(const PreparedInput&);

} // namespace abbe
