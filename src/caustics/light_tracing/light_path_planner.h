// Whether paths of light are worth their time in a scene, how many, and where they go.
#pragma once

#include "caustics/light_tracing/light_path_plan.h"
#include "caustics/shared/kernel_jobs.h"
#include "render/integrator.h"

#include <functional>
#include <memory>

namespace abbe {

// Per camera ray: what asking for the densities of light paths costs, in rays.
inline constexpr double kTracedCost = 1.4;

struct PlannedLightPaths {
    std::unique_ptr<const LightPathPlan> plan; // null: none
    LightPathFindings findings;
    double raysBeside = 0; // that its light paths take beside each camera path, in those of camera paths
};

// What scene and technique decide without a look: `undecided` leaves it to planLightPaths().
LightPathVerdict lightPathVerdict(const Scene&, const Technique&);
// Blocks of light paths in a RenderState: 0 where none will be planned.
std::size_t lightBlocksOf(const Scene&, const Technique&);

// Requires lightBlocksOf() > 0 and a context without a plan; the reference is that of the frame. `stop` cuts it short,
// without a plan.
PlannedLightPaths planLightPaths(const PathContext&, const LightPathKernel&, const RouletteReference&,
                                 const std::function<bool()>& stop);

} // namespace abbe
