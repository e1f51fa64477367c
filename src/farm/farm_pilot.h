// What a sample of a scene costs, measured before it is divided into parts.
#pragma once

#include "farm/farm_plan.h"

namespace abbe {

// Seconds of a core for one sample of one pixel, from a small render of the first frame on this machine: some seconds,
// a thousandth of what a shot of hours takes. Leaves nothing behind. Throws FarmFault if the scene does not render.
double measureSample(const FarmPlan&, const FarmFolder&);

} // namespace abbe
