// What paths are made of.
#pragma once

#include "base/parallel.h"
#include "caustics/glints/glint_plan.h"
#include "caustics/light_tracing/light_path_plan.h"
#include "caustics/manifold/manifold_sampler.h"
#include "caustics/merging/merge_plan.h"
#include "light_sampling/light_sampler.h"
#include "render/integrator.h"
#include "render/scene.h"
#include "transport/loop_technique.h"

namespace abbe {

// Everything that the paths of one render share.
struct PathContext {
    const Scene& scene;
    const LightSampler& lights;
    RenderSettings settings;
    bool choices = true;      // whether anything in the scene draws a light, a lobe or a place on a lens
    std::uint32_t strata = 1; // of stratified numbers
    LoopTechnique how = LoopTechnique(settings.technique);
    // For kernels with Effect::lightPaths: paths of light beside them; chains of delta interfaces, and who hears of
    // them.
    const LightPathPlan* traced = nullptr;
    const ManifoldSampler* manifold = nullptr;
    ManifoldListener* hears = nullptr;
    const MergePlan* merging = nullptr; // light that is found by merging, and left out of paths
    const GlintPlan* glints = nullptr;  // likewise by probes
    // Set: what is in hand is left where it is, and does not count (PathCounters::left).
    const StopFlag* stop = &kNeverStop;

    bool toldToStop() const { return stop->load(std::memory_order_relaxed); }
};

} // namespace abbe
