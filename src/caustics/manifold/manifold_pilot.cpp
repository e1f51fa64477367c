#include "caustics/manifold/manifold_pilot.h"

#include <algorithm>

namespace abbe {

ManifoldPilot::ManifoldPilot(const Scene& scene, ManifoldPlan plan)
    : sampler_(scene, std::move(plan)), tallies_(sampler_.plan().casters.size()) {}

void ManifoldPilot::look(const ChainStart& start, float importance, const Wavelengths& lambda, RandomStream& random) {
    for (std::uint32_t caster = 0; caster < tallies_.size(); ++caster)
        for (std::size_t i = 0; i < ManifoldKinds::kCount; ++i) {
            if (!(sampler_.plan().casters[caster].weights[i] > 0)) continue;
            const auto target = sampler_.drawTarget(lambda, start.time, random);
            if (!target) continue;
            ManifoldCounts counts;
            const ManifoldChoice choice{caster, ManifoldKinds::ofIndex(i), 1};
            const auto sample = sampler_.estimate(start, *target, choice, lambda, random, counts);
            Tally& tally = tallies_[caster][i];
            tally.rays += static_cast<double>(counts.rays);
            if (sample) tally.square += square(static_cast<double>(mean(sample->irradiance)) * importance);
            counts_.add(counts);
        }
}

ManifoldPlan ManifoldPilot::learned() const {
    ManifoldPlan plan = sampler_.plan();
    for (std::size_t caster = 0; caster < tallies_.size(); ++caster) {
        std::array<double, ManifoldKinds::kCount> worth{};
        for (std::size_t i = 0; i < worth.size(); ++i) {
            const Tally& tally = tallies_[caster][i];
            if (tally.rays > 0) worth[i] = std::sqrt(tally.square / tally.rays);
        }
        const double best = *std::max_element(worth.begin(), worth.end());
        if (!(best > 0)) continue; // nothing was seen: as it was
        for (std::size_t i = 0; i < worth.size(); ++i) {
            float& weight = plan.casters[caster].weights[i];
            if (weight > 0) weight = std::max(static_cast<float>(worth[i] / best), kLeastWeight);
        }
    }
    return plan;
}

} // namespace abbe
