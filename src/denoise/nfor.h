// The denoiser for final pictures.
#pragma once

#include "denoise/mixture.h"
#include "denoise/prepared_input.h"

namespace abbe {

// Each half by regression on features with NL-means weights [Bitterli2016], twice: first with weights from the noisy
// half itself, then with weights from what became of it, as in [Dabov2007]. All results, those of the wavelets and the
// half as it is are candidates of mix().
Mixture denoiseByRegression(const PreparedInput&);

} // namespace abbe
