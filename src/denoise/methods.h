// The methods of denoising: a fast preview by five levels of wavelets with holes; the denoiser for final pictures,
// which mixes one picture from several denoised ones, by what their two halves say about their errors; and a neural
// network.
#pragma once

#include "denoise/denoise.h"
#include "denoise/half_buffers.h"
#include "denoise/prepared_input.h"

#include <cstdint>
#include <vector>

namespace abbe {

class OidnLibrary;

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
// Two candidates, the second of which is the picture as it is: it wins only where that is certain. `picture` is made of
// `whole`, the first candidate from both halves together.
Mixture mixWithUntouched(const HalfBuffers& noisy, const DenoisedHalves& candidate, const DenoisedHalves& whole);

// Each half by the edge-avoiding wavelets of [Dammertz2010]; differences of its own colours count in units of the
// noise, which shrinks from level to level [Schied2017]. Weights from the other half leave less noise, but then it
// cannot tell any more how large the error is.
DenoisedHalves denoiseByWavelets(const PreparedInput&);

// Each half by regression on features with NL-means weights [Bitterli2016], twice: first with weights from the noisy
// half itself, then with weights from what became of it, as in [Dabov2007]. All results, those of the wavelets and the
// half as it is are candidates of mix().
Mixture denoiseByRegression(const PreparedInput&);

struct OidnResult {
    Mixture mixture;           // `validated` is empty for a look
    std::uint64_t outside = 0; // pixels of the mean with a negative component in Rec. 709
};

// By the network of Open Image Denoise, with features that it has freed of their noise. It takes no negative light, and
// colours outside of Rec. 709 have some there: their negative part is denoised as a picture of its own, and subtracted.
// The whole picture is denoised, and each half with its own features alone, so that the other one knows nothing of it
// and can tell how wrong it is. Where the picture as it is has the smaller error it stays: beside lights that are far
// brighter than all else and a pixel or two wide, the network is wrong by orders of magnitude. A look is without this.
// Throws DenoiserFault and MemoryLimitExceeded.
OidnResult denoiseByOidn(const OidnLibrary&, const NoisyInput&, const Matrix3& toRec709, DenoiseEffort);

} // namespace abbe
