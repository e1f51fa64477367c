// Where light paths go, for people to read.
#pragma once

#include "caustics/light_tracing/light_path_findings.h"

#include <vector>

namespace abbe {

// Those of the same light and target by name added up, the largest shares first, LightPathFindings::kShares at most:
// the last one stands for all that are left. Pairs that nothing is sent to are left out.
std::vector<LightPathShare> largestShares(const std::vector<LightPathShare>&);

} // namespace abbe
