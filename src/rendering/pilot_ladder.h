// How large the pilots of a render are.
#pragma once

#include "rendering/caustic_plans.h"

#include <functional>

namespace abbe {

// What pilots may take.
struct PilotBudget {
    double rays = 0;
    double seconds = 0;        // of the clock; 0: any
    bool atLeastSmall = false; // the smallest pilots are sent whatever they take
};

struct LadderedPlans {
    CausticPlans plans;
    int size = 0;           // RenderSettings::pilot that gives them again; 0: no pilots, no plans
    std::uint64_t rays = 0; // of all pilots that were sent
    double seconds = 0;     // likewise, of the clock
    double secondsOfRay = 0;
};

// Plans by pilots of a size, unless the function says that they shall stop.
using PilotRun = std::function<CausticPlans(int size, const std::function<bool()>& stop)>;

// By pilots of this size.
LadderedPlans plansOf(const PilotRun&, int size, const std::function<bool()>& stop);

// By the largest pilots that the budget has room for. What a larger size takes is foretold from the rays that a smaller
// one took, starting with the smallest, so that without a bound on seconds the size depends on the budget and on
// counts alone. Seconds are foretold likewise, and pilots that go beyond them are cut short and do not count.
LadderedPlans climb(const PilotRun&, const PilotBudget&, const std::function<bool()>& stop);

} // namespace abbe
