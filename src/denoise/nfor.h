// Both halves denoised by regression, with the better bandwidth at each place.
#pragma once

#include "denoise/error_estimate.h"
#include "denoise/prepared_input.h"

namespace abbe {

DenoisedHalves denoiseByRegression(const PreparedInput&);

} // namespace abbe
