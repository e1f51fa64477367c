// A fast preview: five levels of wavelets with holes.
#pragma once

#include "denoise/error_estimate.h"
#include "denoise/prepared_input.h"

namespace abbe {

// Each half by the edge-avoiding wavelets of [Dammertz2010]; differences of its own colours count in units of the
// noise, which shrinks from level to level [Schied2017]. Weights from the other half leave less noise, but then it
// cannot tell any more how large the error is.
DenoisedHalves denoiseByWavelets(const PreparedInput&);

} // namespace abbe
