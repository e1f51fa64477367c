#include "rendering/caustic_plans.h"

namespace abbe {

std::uint64_t CausticPlans::pilotRays() const {
    return light.findings.rays + manifold.findings.rays + merging.findings.rays + glints.findings.pilotRays;
}

double CausticPlans::raysOfSample(double alone) const {
    if (!any()) return alone;
    return kTracedCost * alone + light.raysBeside + manifold.raysBeside + merging.raysBeside + glints.findings.rays;
}

LightPathFindings CausticPlans::findings() const {
    LightPathFindings all = light.findings;
    all.manifold = manifold.findings;
    all.merging = merging.findings;
    all.glints = glints.findings;
    return all;
}

void CausticPlans::giveTo(PathContext& context) const {
    context.lightPaths = light.plan.get();
    context.manifold = manifold.sampler.get();
    context.merging = merging.plan.get();
    context.glints = glints.plan.get();
}

// Each knows of what was planned before it.
CausticPlans planCaustics(const PathContext& plain, const Film& film, const LightPathKernel& kernel,
                          const RouletteReference& roulette, const std::function<bool()>& stop) {
    CausticPlans plans;
    PathContext context = plain;
    plans.light = planLightPaths(context, kernel, roulette, stop);
    plans.giveTo(context);
    plans.manifold = planManifold(context, kernel, roulette, stop);
    plans.giveTo(context);
    if (film.takesMerged()) {
        plans.merging = planMerging(context, kernel, roulette, plans.light.findings, stop);
        if (plans.manifold.sampler && plans.merging.plan)
            plans.manifold.besideMerging(context.scene, plans.merging.plan->lights);
        plans.giveTo(context);
    }
    plans.glints = planGlints(context, film, kernel, roulette, stop);
    return plans;
}

} // namespace abbe
