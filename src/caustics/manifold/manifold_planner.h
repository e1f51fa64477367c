// Whether caustics behind glass and in mirrors are worth manifold sampling in a scene.
#pragma once

#include "caustics/manifold/manifold_sampler.h"
#include "caustics/shared/kernel_jobs.h"
#include "render/integrator.h"

#include <functional>
#include <memory>
#include <unordered_set>

namespace abbe {

struct PlannedManifold {
    std::unique_ptr<const ManifoldSampler> sampler; // null: none
    ManifoldFindings findings;
    double raysBeside = 0; // that estimates take beside each camera path

    // Leaves large images of lamps whose light is merged to merging, and rare kinds of chains if all of it is. Requires
    // a sampler; may leave none.
    void besideMerging(const Scene&, const std::unordered_set<const Light*>& mergedLights);
};

// A context with the plan of light paths, if any; the reference is that of the frame. `stop` cuts it short, without a
// plan. Depends on the scene, the frame, the seed and the
// size of the pilots alone.
PlannedManifold planManifold(const PathContext&, const LightPathKernel&, const RouletteReference&,
                             const std::function<bool()>& stop);

} // namespace abbe
