// Photon merging: whether it is worth its time, and its bias, in a scene.
#pragma once

#include "caustics/merging/merge_plan.h"
#include "caustics/shared/caustic_technique.h"

#include <memory>

namespace abbe {

struct PlannedMerging {
    std::unique_ptr<const MergePlan> plan; // null: none
    MergeFindings findings;
    double raysBeside = 0; // that rounds take beside each camera path, in those of camera paths
};

// Planned after light tracing, whose findings it goes by, and after manifold sampling.
class PhotonMerging final : public CausticTechnique {
  public:
    void plan(const PilotInput&) override;
    bool used() const override { return planned_.plan != nullptr; }
    void giveTo(PathContext& context) const override { context.merging = planned_.plan.get(); }
    std::optional<TileResult> render(const PathContext&, const LightPathKernel&, Film&, const BlockJob&) const override;
    void report(CausticFindings& to) const override { to.of<MergeFindings>() = planned_.findings; }
    Rays rays() const override { return {planned_.findings.rays, planned_.raysBeside}; }
    const LightSet* takes() const override { return planned_.plan ? &planned_.plan->lights : nullptr; }

  private:
    PlannedMerging planned_;
};

} // namespace abbe
