// What serves caustics in a render, planned by pilots of one size.
#pragma once

#include "caustics/glints/glint_planner.h"
#include "caustics/light_tracing/light_path_planner.h"
#include "caustics/manifold/manifold_planner.h"
#include "caustics/merging/merge_planner.h"

namespace abbe {

struct CausticPlans {
    PlannedLightPaths light;
    PlannedManifold manifold;
    PlannedMerging merging;
    PlannedGlints glints;

    // Whether there is anything that camera paths alone do not do.
    bool any() const { return light.plan || manifold.sampler || merging.plan || glints.plan; }
    // That the pilots took.
    std::uint64_t pilotRays() const;
    // That a sample of a pixel takes, in those of camera paths, if one of these alone takes `alone`.
    double raysOfSample(double alone) const;
    // Of all four.
    LightPathFindings findings() const;
    // Refers to the plans, which must outlive it.
    void giveTo(PathContext&) const;
};

// By pilots of the size PathContext::settings.pilot, above 0. Requires lightBlocksOf() > 0 and a context without plans;
// the film tells its filter and whether it takes merged light alone, the reference is that of the frame. `stop` cuts
// it short, and then the plans are good for nothing.
CausticPlans planCaustics(const PathContext&, const Film&, const LightPathKernel&, const RouletteReference&,
                          const std::function<bool()>& stop);

} // namespace abbe
