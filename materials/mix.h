// A mixture of two materials: rust on steel, dust on glass, by a share that may vary over the surface.
#pragma once

#include "render/bsdf.h"
#include "render/material.h"
#include "schema/type.h"

#include <memory>

namespace abbe {

struct MixParams {
    schema::Reference first, second;                 // materials
    schema::TexturedNumber amount{0.5, nullptr, {}}; // share of the second one, 0 … 1
};

schema::TypeInfo mixMaterialType();
// Refers to both, which must outlive it. Requires that at most one of them has an inside, or that their insides are the
// same (sameInside), and that neither is a boundary or emits.
std::unique_ptr<const Material> makeMix(const MixParams&, const Material& first, const Material& second);

// Whether light may enter closed shapes of the material.
bool hasInside(const Material&);
// Whether two materials fill shapes with the same: index, absorption and medium.
bool sameInside(const Material&, const Material&);

// Two scattering functions side by side, so fine that each point has its share of both.

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
