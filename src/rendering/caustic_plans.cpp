#include "rendering/caustic_plans.h"

#include "base/stopwatch.h"
#include "caustics/glints/glint_probing.h"
#include "caustics/light_tracing/light_tracing.h"
#include "caustics/manifold/manifold_sampling.h"
#include "caustics/merging/photon_merging.h"
#include "caustics/shared/pilot.h"

#include <algorithm>
#include <cmath>

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

namespace {

// Sends pilots of a size; whether they came back in time.
bool send(const PilotRun& run, int size, const std::function<bool()>& stop, LadderedPlans& to) {
    const Stopwatch watch;
    CausticPlans plans = run(size, stop);
    const double seconds = watch.seconds();
    to.rays += plans.pilotRays();
    to.seconds += seconds;
    if (stop()) return false;
    to.secondsOfRay = seconds / static_cast<double>(std::max<std::uint64_t>(1, plans.pilotRays()));
    to.plans = std::move(plans);
    to.size = size;
    return true;
}

} // namespace

LadderedPlans plansOf(const PilotRun& run, int size, const std::function<bool()>& stop) {
    LadderedPlans result;
    if (size > 0) send(run, size, stop, result);
    return result;
}

LadderedPlans climb(const PilotRun& run, const PilotBudget& budget, const std::function<bool()>& stop) {
    LadderedPlans result;
    const Stopwatch watch;
    const auto stopInTime = [&] {
        const bool whole = budget.atLeastSmall && result.size == 0;
        return stop() || (budget.seconds > 0 && !whole && watch.seconds() > budget.seconds);
    };
    const auto fits = [&](int size) {
        const double factor = std::pow(PilotSize::kPilotStep, size - result.size);
        const double rays = factor * static_cast<double>(result.plans.pilotRays());
        if (static_cast<double>(result.rays) + rays > budget.rays) return false;
        return !(budget.seconds > 0) || result.seconds + rays * result.secondsOfRay <= budget.seconds;
    };
    int next = 1;
    while (next > result.size && send(run, next, stopInTime, result)) {
        next = RenderSettings::kFullPilot;
        while (next > result.size && !fits(next)) --next;
    }
    return result;
}

} // namespace abbe
