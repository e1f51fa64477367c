// What focuses light, for paths of light to be sent to.
#pragma once

#include "integrators/emission_plan.h"
#include "math/bounds.h"

namespace abbe {

// Balls around boxes, as far as they are in the scene's; those near one another are put together, so that few are left
// to look at for every density.
std::vector<AimTarget> aimTargets(const std::vector<Bounds3>& focusing, const Bounds3& scene);

} // namespace abbe
