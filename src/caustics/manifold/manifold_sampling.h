// Manifold sampling: whether caustics behind glass and in mirrors are worth it in a scene.
#pragma once

#include "caustics/manifold/manifold_findings.h"
#include "caustics/manifold/manifold_sampler.h"
#include "caustics/shared/caustic_technique.h"

#include <memory>

namespace abbe {

struct PlannedManifold {
    std::unique_ptr<const ManifoldSampler> sampler; // null: none
    ManifoldFindings findings;
    double raysBeside = 0; // that estimates take beside each camera path
};

// Planned after light tracing.
class ManifoldSampling final : public CausticTechnique {
  public:
    ManifoldSampling() = default;
    explicit ManifoldSampling(PlannedManifold planned) : planned_(std::move(planned)) {}

    void plan(const PilotInput&) override;
    bool used() const override { return planned_.sampler != nullptr; }
    void giveTo(PathContext& context) const override { context.manifold = planned_.sampler.get(); }
    void report(CausticFindings& to) const override { to.of<ManifoldFindings>() = planned_.findings; }
    Rays rays() const override { return {planned_.findings.rays, planned_.raysBeside}; }
    // To merging: large images of lights, and rare kinds of chains if all light is merged; may leave nothing here.
    void leave(const Scene&, const LightSet& merged) override;

    const PlannedManifold& planned() const { return planned_; }

  private:
    PlannedManifold planned_;
};

} // namespace abbe
