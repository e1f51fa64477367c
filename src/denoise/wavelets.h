// A fast preview: five levels of wavelets with holes.
#pragma once

#include "denoise/error_estimate.h"
#include "denoise/prepared_input.h"

namespace abbe {

// Each half by the edge-avoiding wavelets of [Dammertz2010]; differences of colour count in units of the noise, which
// is that of the other half and shrinks from level to level [Schied2017].
DenoisedHalves denoiseByWavelets(const PreparedInput&);

} // namespace abbe
