// Which glints, small images of lamps in mirrors and clear glass, are probed.
#pragma once

#include "caustics/glints/glint_plan.h"
#include "caustics/glints/glint_search.h"
#include "caustics/shared/kernel_jobs.h"
#include "render/integrator.h"

#include <functional>
#include <memory>

namespace abbe {

struct PlannedGlints {
    std::unique_ptr<const GlintPlan> plan; // null: none
    GlintFindings findings;
};

// The film tells the pixel filter alone; the reference is that of the frame. `stop` cuts it short, without a plan.
PlannedGlints planGlints(const PathContext&, const Film&, const LightPathKernel&, const RouletteReference&,
                         const std::function<bool()>& stop);

} // namespace abbe
