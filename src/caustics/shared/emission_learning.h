// Where light paths should start, from what some of them brought.
#pragma once

#include "caustics/shared/aimed_emission.h"
#include "caustics/shared/noise_measure.h"

#include <span>

namespace abbe {

// `even` is the plan that the paths were drawn by; `lights` those of the scene. In proportion to the root of the second
// moment of what paths bring from there, which leaves the least variance [Neyman1934], of shares of lights and targets
// and of parts of targets' cones alike; a rest stays even, so that nothing is forgotten that a pilot did not see. What
// camera paths find, too, counts as light paths are weighed, and not at all where they find it without fireflies; or in
// full for those `alone`.
EmissionPlan learnEmission(const EmissionPlan& even, std::size_t lights, std::span<const LightStart>,
                           std::span<const LightDeposit>, const NoiseMeasure&, bool alone);

} // namespace abbe
