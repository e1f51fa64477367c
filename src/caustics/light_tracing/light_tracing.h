// Light tracing: whether paths of light are worth their time in a scene, how many, and where they go.
#pragma once

#include "caustics/light_tracing/light_path_plan.h"
#include "caustics/shared/caustic_technique.h"

#include <memory>

namespace abbe {

struct PlannedLightPaths {
    std::unique_ptr<const LightPathPlan> plan; // null: none
    LightPathFindings findings;
    double raysBeside = 0; // that its light paths take beside each camera path, in those of camera paths
};

// The first to be planned. Requires lightBlocksOf() > 0.
class LightTracing final : public CausticTechnique {
  public:
    void plan(const PilotInput&) override;
    bool used() const override { return planned_.plan != nullptr; }
    void giveTo(PathContext& context) const override { context.lightPaths = planned_.plan.get(); }
    std::optional<TileResult> render(const PathContext&, const LightPathKernel&, Film&, const BlockJob&) const override;
    void report(CausticFindings& to) const override { to.of<LightPathFindings>() = planned_.findings; }
    Rays rays() const override { return {planned_.findings.rays, planned_.raysBeside}; }

  private:
    PlannedLightPaths planned_;
};

} // namespace abbe
