// Manifold sampling as a technique for caustics: whether it pays in a scene, and for which chains.
#pragma once

#include "caustics/manifold/manifold_plan.h"
#include "caustics/manifold/manifold_sampler.h"
#include "caustics/shared/caustic_technique.h"

#include <memory>

namespace abbe {

// Learns which kinds of chains are worth trying. Looks at points that paths reach, before light is gathered, and sets
// SpecularCaster::weights so that a second brings the most: in proportion to the root of the mean square of a kind's
// light over its rays. Kinds that found nothing keep a small share, since a pilot sees little; what is covered does not
// change. Not thread-safe; deterministic.
class ManifoldPilot {
  public:
    // Of kinds that found little or nothing; the best of a caster has 1.
    static constexpr float kLeastWeight = 0.02f;

    // The scene must outlive it. The plan is one for ManifoldSampler.
    ManifoldPilot(const Scene&, ManifoldPlan);

    // Tries all kinds of all casters once. `importance`: what irradiance there counts in the picture, of any scale.
    void look(const ChainStart&, float importance, const Wavelengths&, RandomStream&);
    ManifoldPlan learned() const;
    const ManifoldCounts& counts() const { return counts_; }

  private:
    struct Tally {
        double square = 0; // of the light, summed
        double rays = 0;
    };

    ManifoldSampler sampler_;
    std::vector<std::array<Tally, ManifoldKinds::kCount>> tallies_; // by caster
    ManifoldCounts counts_;
};

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
