#include "rendering/caustic_plans.h"

#include "caustics/glints/glint_probing.h"
#include "caustics/light_tracing/light_tracing.h"
#include "caustics/manifold/manifold_sampling.h"
#include "caustics/merging/photon_merging.h"

#include <algorithm>

namespace abbe {

bool CausticPlans::any() const {
    return std::ranges::any_of(techniques_, [](const auto& t) { return t->used(); });
}

std::uint64_t CausticPlans::pilotRays() const {
    std::uint64_t sum = 0;
    for (const auto& technique : techniques_) sum += technique->rays().pilot;
    return sum;
}

double CausticPlans::raysOfSample(double alone) const {
    if (!any()) return alone;
    double sum = kCostBesideLightPaths * alone;
    for (const auto& technique : techniques_) sum += technique->rays().beside;
    return sum;
}

CausticFindings CausticPlans::findings() const {
    CausticFindings all;
    for (const auto& technique : techniques_) technique->report(all);
    return all;
}

void CausticPlans::giveTo(PathContext& context) const {
    for (const auto& technique : techniques_) technique->giveTo(context);
}

// Units of a technique follow those of the one before it.
TileResult CausticPlans::render(const PathContext& context, const LightPathKernel& kernel, Film& film,
                                const BlockJob& job) const {
    TileResult all;
    std::uint32_t before = 0;
    for (const auto& technique : techniques_) {
        BlockJob own = job;
        own.from = job.from.unit < before ? PortionPlace() : PortionPlace{job.from.unit - before, job.from.done};
        std::optional<TileResult> result = technique->render(context, kernel, film, own);
        if (!result) continue;
        if (result->rest) result->rest->unit += before;
        all.add(*result);
        if (all.rest) break;
        before += job.units(film);
    }
    return all;
}

CausticPlans planCaustics(const PathContext& plain, const Film& film, const LightPathKernel& kernel,
                          const RouletteReference& roulette, const std::function<bool()>& stop) {
    std::vector<std::unique_ptr<CausticTechnique>> techniques; // each knows of what was planned before it
    techniques.push_back(std::make_unique<LightTracing>());
    techniques.push_back(std::make_unique<ManifoldSampling>());
    techniques.push_back(std::make_unique<PhotonMerging>());
    techniques.push_back(std::make_unique<GlintProbing>());
    PathContext context = plain;
    CausticFindings found;
    for (const auto& technique : techniques) {
        technique->plan({context, film, kernel, roulette, found, stop});
        technique->report(found);
        if (const LightSet* const taken = technique->takes())
            for (const auto& before : techniques) {
                if (before == technique) break;
                before->leave(context.scene, *taken);
            }
        for (const auto& other : techniques) other->giveTo(context);
    }
    return CausticPlans(std::move(techniques));
}

} // namespace abbe
