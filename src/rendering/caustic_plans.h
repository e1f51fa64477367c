// What serves caustics in a render, planned by pilots of one size.
#pragma once

#include "caustics/shared/caustic_technique.h"

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

} // namespace abbe
