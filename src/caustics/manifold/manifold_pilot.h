// Learns which kinds of chains are worth trying.
#pragma once

#include "caustics/manifold/manifold_sampler.h"

namespace abbe {

// Looks at points that paths reach, before light is gathered, and sets SpecularCaster::weights so that a second brings
// the most: in proportion to the root of the mean square of a kind's light over its rays. Kinds that found nothing keep
// a small share, since a pilot sees little; what is covered does not change. Not thread-safe; deterministic.
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

} // namespace abbe
