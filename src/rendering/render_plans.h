// All that is decided before the first sample of a render.
#pragma once

#include "rendering/caustic_plans.h"
#include "rendering/guide_plan.h"
#include "rendering/look_ahead.h"

#include <functional>

namespace abbe {

struct PlanInput {
    const PathContext& context; // without plans; its settings say what the render is to be
    TileFunction render;        // of the kernel without light paths
    const LightPathKernel& lightPaths;
    const Film& film;
    RenderState& state;                                   // is told the size of the pilots; one that it has stays
    const std::function<void(const FramePreview&)>& seen; // may be empty
    const std::function<double()>& timeLeft;              // s, where the settings have a time limit
    const std::function<bool()>& stop;
};

struct RenderPlans {
    LookAhead ahead;
    CausticPlans caustics;
    CausticFindings findings; // with those of the guide
    std::unique_ptr<const PathGuide> guide;
    std::uint64_t rays = 0; // that all of it took
    double seconds = 0;     // of the clock, likewise
    double coreSeconds = 0; // of all threads, likewise
};

// The pilots are of the size that the state has, else of that of the settings. Depends on scene, frame and settings
// alone, but for the size where there is a time limit, and unless `stop` cuts it short.
RenderPlans planRender(const PlanInput&);

} // namespace abbe
