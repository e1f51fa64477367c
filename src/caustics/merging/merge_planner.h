// Whether merging is worth its time, and its bias, in a scene.
#pragma once

#include "caustics/merging/merge_plan.h"
#include "caustics/shared/kernel_jobs.h"
#include "render/integrator.h"

#include <functional>
#include <memory>

namespace abbe {

struct PlannedMerging {
    std::unique_ptr<const MergePlan> plan; // null: none
    MergeFindings findings;
    double raysBeside = 0; // that rounds take beside each camera path, in those of camera paths
};

// A context with the plans of light paths and of manifold sampling, if any, and what was found about the first; the
// reference is that of the frame. `stop` cuts it short, without a plan.
PlannedMerging planMerging(const PathContext&, const LightPathKernel&, const RouletteReference&,
                           const LightPathFindings&, const std::function<bool()>& stop);

} // namespace abbe
