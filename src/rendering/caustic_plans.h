// What serves caustics in a render, planned by pilots of one size; and how large the pilots of a render are.
#pragma once

#include "caustics/shared/caustic_technique.h"

#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace abbe {

class CausticPlans {
  public:
    CausticPlans() = default; // of nothing
    // In the order in which they are planned.
    explicit CausticPlans(std::vector<std::unique_ptr<CausticTechnique>> techniques)
        : techniques_(std::move(techniques)) {}

    // Whether there is anything that camera paths alone do not do.
    bool any() const;
    // That the pilots took.
    std::uint64_t pilotRays() const;
    // That a sample of a pixel takes, in those of camera paths, if one of these alone takes `alone`.
    double raysOfSample(double alone) const;
    CausticFindings findings() const;
    // Refers to the plans, which must outlive it.
    void giveTo(PathContext&) const;
    // What a block has beside tiles of camera paths: of each technique in turn.
    TileResult render(const PathContext&, const LightPathKernel&, Film&, const BlockJob&) const;

  private:
    std::vector<std::unique_ptr<CausticTechnique>> techniques_;
};

// By pilots of the size PathContext::settings.pilot, above 0. Requires lightBlocksOf() > 0 and a context without plans;
// the film tells its filter and whether it takes merged light alone, the reference is that of the frame. `stop` cuts
// it short, and then the plans are good for nothing.
CausticPlans planCaustics(const PathContext&, const Film&, const LightPathKernel&, const RouletteReference&,
                          const std::function<bool()>& stop);

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

// By the largest pilots that the budget has room for. What a larger size takes is predicted from the rays that a
// smaller one took, starting with the smallest, so that without a bound on seconds the size depends on the budget and
// on counts alone. Seconds are predicted likewise, and pilots that go beyond them are cut short and do not count.
LadderedPlans climb(const PilotRun&, const PilotBudget&, const std::function<bool()>& stop);

} // namespace abbe
