// Scattering some of whose directions come from elsewhere: drawn evenly, which is what importance sampling is compared
// with and checked against, or guided to where light comes from.
#pragma once

#include "guiding/path_guide.h"
#include "math/frame.h"
#include "math/warp.h"
#include "render/bsdf.h"

#include <algorithm>
#include <cmath>

namespace abbe {

// A direction in the frame of the surface.
struct Drawn {
    Vec3 wi;
    float pdf; // 1/sr
};

// Even over the hemisphere of the eye or, where light is let through, over the sphere.
struct EvenDirections {
    static float density(Lobes lobes, Vec3) { return lobes.has(Lobe::transmission) ? kSpherePdf : 2 * kSpherePdf; }
    static Drawn sample(Lobes lobes, Vec3 wo, Vec2 u) {
        // The upper hemisphere is the first half of the square.
        Vec3 wi = squareToSphere(lobes.has(Lobe::transmission) ? u : Vec2{0.5f * u.x, u.y});
        if (wo.z < 0) wi.z = -wi.z;
        return {wi, density(lobes, wi)};
    }
};

// As a region of a guide has learnt them; all three outlive it.
struct GuidedDirections {
    const PathGuide& guide;
    const PathGuide::Region& region;
    Vec3 p;
    const Frame& shading;

    // What is expected from there, which the path needs to know.
    float* radiance;

    float density(Lobes, Vec3 wi) const {
        const PathGuide::Direction found = guide.look(region, p, shading.toWorld(wi));
        *radiance = found.radiance;
        return found.pdf;
    }
    Drawn sample(Lobes, Vec3, Vec2 u) const {
        const PathGuide::Direction found = guide.sample(region, p, u);
        *radiance = found.radiance;
        return {shading.toLocal(found.w), found.pdf};
    }
};

// The same values as another Bsdf, found by a mixture of its own directions and of others: defensive importance
// sampling [Hesterberg1995]. Weights are eval() over the density of the mixture; those that the Bsdf itself puts on its
// samples count for delta lobes alone, which no other density finds.
template <typename Directions> class DirectedBsdf final : public Bsdf {
  public:
    // `own` outlives it. `eta`: index of the side away from the eye over that of the eye's side. `share`: of the other
    // directions, in (0, 1]. With 1 half of the samples are still the Bsdf's own where it has delta lobes beside
    // others, and those of them that are not delta count as nothing. Below 1 a dispersive Bsdf stands as it is: where
    // the hero's density is 0, that of the other wavelengths in the mixture is not known.
    DirectedBsdf(const Bsdf& own, float eta, float share, const Directions& others = {})
        : own_(own), others_(others), eta_(eta), lobes_(own.lobes()) {
        if (!lobes_.any(Lobes(Lobe::diffuse) | Lobe::glossy) || (share < 1 && lobes_.has(Lobe::dispersive))) return;
        mixed_ = share < 1 ? share : lobes_.has(Lobe::delta) ? 0.5f : 1;
        followed_ = share < 1 ? 1 - mixed_ : 0;
    }

    Lobes lobes() const noexcept override { return lobes_; }
    BsdfEval eval(Vec3 wo, Vec3 wi, Transport transport) const noexcept override {
        const BsdfEval e = own_.eval(wo, wi, transport);
        return mixed_ > 0 ? mixed(e, wi) : e;
    }
    std::optional<BsdfSample> sample(Vec3 wo, float uLobe, Vec2 u, Transport transport) const noexcept override {
        if (!(mixed_ > 0)) return own_.sample(wo, uLobe, u, transport);
        if (uLobe >= mixed_)
            return sampleOwn(wo, std::min((uLobe - mixed_) / (1 - mixed_), kOneMinusEpsilon), u, transport);
        const auto [wi, density] = others_.sample(lobes_, wo, u);
        const bool through = wo.z * wi.z < 0;
        Lobes lobe = lobes_.has(Lobe::diffuse) ? Lobe::diffuse : Lobe::glossy;
        lobe |= through ? Lobe::transmission : Lobe::reflection;
        return weighed(mixed(own_.eval(wo, wi, transport), density), wi, lobe, through ? eta_ : 1.f);
    }
    DeltaEval evalDelta(Vec3 wo, Vec3 wi) const noexcept override {
        DeltaEval e = own_.evalDelta(wo, wi);
        e.probability *= 1 - mixed_;
        return e;
    }
    ScatterOutline outline(Vec3 wo) const noexcept override { return own_.outline(wo); }
    // With which the surface itself would have found a direction.
    float ownDensity(Vec3 wo, Vec3 wi) const { return own_.eval(wo, wi, Transport::radiance).pdfSolidAngle; }

  private:
    BsdfEval mixed(BsdfEval e, Vec3 wi) const {
        // Where nothing is scattered no density is asked for, and the lookup is spared.
        return anyNonZero(e.fcos) ? mixed(e, others_.density(lobes_, wi)) : e;
    }
    BsdfEval mixed(BsdfEval e, float othersDensity) const {
        e.pdfSolidAngle = mixed_ * othersDensity + followed_ * e.pdfSolidAngle;
        e.pdfRatio = Spectrum(1.f);
        return e;
    }
    static std::optional<BsdfSample> weighed(const BsdfEval& mixed, Vec3 wi, Lobes lobe, float eta) {
        if (!anyNonZero(mixed.fcos) || !(mixed.pdfSolidAngle > 0)) return std::nullopt;
        return std::optional<BsdfSample>(std::in_place, wi, mixed.fcos / mixed.pdfSolidAngle, mixed.pdfSolidAngle, lobe,
                                         eta);
    }
    std::optional<BsdfSample> sampleOwn(Vec3 wo, float uLobe, Vec2 u, Transport transport) const {
        auto s = own_.sample(wo, uLobe, u, transport);
        if (!s) return s;
        if (s->lobe.has(Lobe::delta)) {
            s->weight *= 1 / (1 - mixed_);
            s->pdfSolidAngle *= 1 - mixed_;
            return s;
        }
        return followed_ > 0 ? weighed(mixed(own_.eval(wo, s->wi, transport), s->wi), s->wi, s->lobe, s->eta)
                             : std::nullopt;
    }

    const Bsdf& own_;
    Directions others_;
    float eta_;
    Lobes lobes_;
    float mixed_ = 0, followed_ = 0; // shares of other directions, 0: none, and of own ones that count
};

using DefensiveBsdf = DirectedBsdf<EvenDirections>;
using GuidedBsdf = DirectedBsdf<GuidedDirections>;

} // namespace abbe
