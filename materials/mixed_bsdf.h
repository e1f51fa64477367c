// Two scattering functions side by side, so fine that each point has its share of both.
#pragma once

#include "render/bsdf.h"

namespace abbe {

// f = (1 - amount) f₁ + amount f₂. A sample comes from one of them, chosen by its share, and is weighed with both;
// their delta lobes, which nothing else can find, keep their own weight, because the share is in the choice already.
class MixedBsdf final : public Bsdf {
  public:
    // Requires 0 < amount < 1.
    MixedBsdf(const Bsdf& first, const Bsdf& second, float amount)
        : parts_{&first, &second}, shares_{1 - amount, amount} {}

    Lobes lobes() const noexcept override { return parts_[0]->lobes() | parts_[1]->lobes(); }
    BsdfEval eval(Vec3 wo, Vec3 wi, Transport) const noexcept override;
    std::optional<BsdfSample> sample(Vec3 wo, float uLobe, Vec2 u, Transport) const noexcept override;
    DeltaEval evalDelta(Vec3 wo, Vec3 wi) const noexcept override;
    ScatterOutline outline(Vec3 wo) const noexcept override;

  private:
    const Bsdf* parts_[2];
    float shares_[2];
};

} // namespace abbe
