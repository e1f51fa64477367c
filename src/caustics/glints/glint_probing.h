// Glint probing: which glints, small images of lights in mirrors and clear glass, are probed.
#pragma once

#include "caustics/glints/glint_plan.h"
#include "caustics/shared/caustic_technique.h"

#include <memory>

namespace abbe {

struct PlannedGlints {
    std::unique_ptr<const GlintPlan> plan; // null: none
    GlintFindings findings;
};

// Planned last.
class GlintProbing final : public CausticTechnique {
  public:
    void plan(const PilotInput&) override;
    bool used() const override { return planned_.plan != nullptr; }
    void giveTo(PathContext& context) const override { context.glints = planned_.plan.get(); }
    void report(CausticFindings& to) const override { to.of<GlintFindings>() = planned_.findings; }
    Rays rays() const override { return {planned_.findings.pilotRays, planned_.findings.rays}; }

  private:
    PlannedGlints planned_;
};

} // namespace abbe
