#include "rendering/pilot_ladder.h"

#include "base/stopwatch.h"
#include "caustics/shared/pilot.h"

#include <cmath>

namespace abbe {

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
