// The block `layers { … }` of a film.
#pragma once

#include "base/diagnostic.h"
#include "film/layer_plan.h"
#include "schema/type.h"

namespace abbe {

// One row for each layer: `albedo`, `light-group key lamp1 lamp2`, `spectral 380 780 10`. Faults are reported where
// they stand, and what is sound is taken.
LayerPlan layerPlan(const schema::TableRows&, Diagnostics&);

} // namespace abbe
