// What a render would take without an effect, told from its cost report.
#pragma once

#include "scene/effect_switches.h"
#include "study/cost.h"

#include <optional>

namespace abbe {

// Seconds of rendering without it, as CostReport::rendering; nothing where the cost report has nothing to tell it by.
//
// Of a medium: as long as no medium has scattered a path, each of its rays is the path's last one with a probability
// that does not depend on the medium. Paths that the medium would have scattered go on with it, so that there are
// N (U - C) / (N - C) such rays in place of U, for N paths of which it scattered C first. Each takes along what it did;
// following the medium, and all that came after its scattering, is no more. Where it scattered most paths nothing is
// told.
std::optional<double> renderingWithout(const CostReport&, const EffectSwitch&);

} // namespace abbe
