// Scattering some of whose directions are drawn evenly, whatever the surface does: what importance sampling is compared
// with and checked against.
#pragma once

#include "math/warp.h"
#include "render/bsdf.h"

#include <algorithm>
#include <cmath>

namespace abbe {

// The same values as another Bsdf, found by a mixture of its own directions and of even ones over the hemisphere of the
// eye or, where light is let through, over the sphere: defensive importance sampling [Hesterberg1995]. Weights are
// eval() over the density of the mixture; those that the Bsdf itself puts on its samples count for delta lobes alone,
// which no even density finds.
class DefensiveBsdf final : public Bsdf {
  public:
    // `own` outlives it. `eta`: index of the side away from the eye over that of the eye's side. `share`: of the even
    // directions, in (0, 1]. With 1 half of the samples are still the Bsdf's own where it has delta lobes beside
    // others, and those of them that are not delta count as nothing. Below 1 a dispersive Bsdf stands as it is: where
    // the hero's density is 0, that of the other wavelengths in the mixture is not known.
    DefensiveBsdf(const Bsdf& own, float eta, float share) : own_(own), eta_(eta), lobes_(own.lobes()) {
        if (!lobes_.any(Lobes(Lobe::diffuse) | Lobe::glossy) || (share < 1 && lobes_.has(Lobe::dispersive))) return;
        even_ = share < 1 ? share : lobes_.has(Lobe::delta) ? 0.5f : 1;
        followed_ = share < 1 ? 1 - even_ : 0;
    }

    Lobes lobes() const noexcept override { return lobes_; }
    BsdfEval eval(Vec3 wo, Vec3 wi, Transport transport) const noexcept override {
        const BsdfEval e = own_.eval(wo, wi, transport);
        return even_ > 0 ? mixed(e) : e;
    }
    std::optional<BsdfSample> sample(Vec3 wo, float uLobe, Vec2 u, Transport transport) const noexcept override {
        if (!(even_ > 0)) return own_.sample(wo, uLobe, u, transport);
        if (uLobe >= even_)
            return sampleOwn(wo, std::min((uLobe - even_) / (1 - even_), kOneMinusEpsilon), u, transport);
        // The upper hemisphere is the first half of the square.
        Vec3 wi = squareToSphere(lobes_.has(Lobe::transmission) ? u : Vec2{0.5f * u.x, u.y});
        if (wo.z < 0) wi.z = -wi.z;
        const bool through = wo.z * wi.z < 0;
        Lobes lobe = lobes_.has(Lobe::diffuse) ? Lobe::diffuse : Lobe::glossy;
        lobe |= through ? Lobe::transmission : Lobe::reflection;
        return weighed(wo, wi, lobe, through ? eta_ : 1.f, transport);
    }
    DeltaEval evalDelta(Vec3 wo, Vec3 wi) const noexcept override {
        DeltaEval e = own_.evalDelta(wo, wi);
        e.probability *= 1 - even_;
        return e;
    }
    ScatterOutline outline(Vec3 wo) const noexcept override { return own_.outline(wo); }
    // With which the surface itself would have found a direction.
    float ownDensity(Vec3 wo, Vec3 wi) const { return own_.eval(wo, wi, Transport::radiance).pdfSolidAngle; }

  private:
    float density() const { return lobes_.has(Lobe::transmission) ? kSpherePdf : 2 * kSpherePdf; }
    BsdfEval mixed(BsdfEval e) const {
        e.pdfSolidAngle = even_ * density() + followed_ * e.pdfSolidAngle;
        e.pdfRatio = Spectrum(1.f);
        return e;
    }
    std::optional<BsdfSample> weighed(Vec3 wo, Vec3 wi, Lobes lobe, float eta, Transport transport) const {
        const BsdfEval e = mixed(own_.eval(wo, wi, transport));
        if (!anyNonZero(e.fcos) || !(e.pdfSolidAngle > 0)) return std::nullopt;
        return std::optional<BsdfSample>(std::in_place, wi, e.fcos / e.pdfSolidAngle, e.pdfSolidAngle, lobe, eta);
    }
    std::optional<BsdfSample> sampleOwn(Vec3 wo, float uLobe, Vec2 u, Transport transport) const {
        auto s = own_.sample(wo, uLobe, u, transport);
        if (!s) return s;
        if (s->lobe.has(Lobe::delta)) {
            s->weight *= 1 / (1 - even_);
            s->pdfSolidAngle *= 1 - even_;
            return s;
        }
        return followed_ > 0 ? weighed(wo, s->wi, s->lobe, s->eta, transport) : std::nullopt;
    }

    const Bsdf& own_;
    float eta_;
    Lobes lobes_;
    float even_ = 0, followed_ = 0; // shares of even directions, 0: none, and of own ones that count
};

} // namespace abbe
