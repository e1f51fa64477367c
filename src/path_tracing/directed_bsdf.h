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

// Even over the hemisphere of the eye or, where light is let through, over the sphere; in the frame of the surface.
struct EvenDirections {
    static float density(Lobes lobes) { return lobes.has(Lobe::transmission) ? kSpherePdf : 2 * kSpherePdf; }
    static Vec3 sample(Lobes lobes, Vec3 wo, Vec2 u) {
        // The upper hemisphere is the first half of the square.
        Vec3 wi = squareToSphere(lobes.has(Lobe::transmission) ? u : Vec2{0.5f * u.x, u.y});
        if (wo.z < 0) wi.z = -wi.z;
        return wi;
    }
};

// A guide's share of what a surface scatters: one direction of the mixture of both. Delta lobes are the surface's
// alone.
struct GuidedSample {
    std::optional<BsdfSample> next;
    float ownPdf = 0;   // with which the surface itself would have found it, 1/sr
    float radiance = 1; // expected from there, over that of the frame in the mean

    // Requires a view that guides and a Bsdf that has a diffuse lobe and does not disperse. `eta`: as DefensiveBsdf
    // takes it.
    static GuidedSample of(const PathGuide::View& view, const Bsdf& own, const Frame& shading, float eta, Vec3 wo,
                           float uLobe, Vec2 u) {
        const float share = view.guided();
        GuidedSample result;
        if (uLobe < share) {
            const PathGuide::Direction found = view.sample(u);
            const Vec3 wi = shading.toLocal(found.w);
            const BsdfEval e = own.eval(wo, wi, Transport::radiance);
            const float pdf = view.mixed(e.pdfSolidAngle, found.pdf);
            if (!anyNonZero(e.fcos) || !(pdf > 0)) return result;
            result.ownPdf = e.pdfSolidAngle;
            result.radiance = found.radiance;
            const bool through = wo.z * wi.z < 0;
            const Lobes lobe = Lobes(Lobe::diffuse) | (through ? Lobe::transmission : Lobe::reflection);
            result.next.emplace(wi, e.fcos / pdf, pdf, lobe, through ? eta : 1.f);
            return result;
        }
        result.next = own.sample(wo, std::min((uLobe - share) / (1 - share), kOneMinusEpsilon), u, Transport::radiance);
        if (!result.next) return result;
        BsdfSample& next = *result.next;
        if (next.lobe.has(Lobe::delta)) {
            next.weight *= 1 / (1 - share);
            next.pdfSolidAngle *= 1 - share;
            return result;
        }
        const PathGuide::Direction found = view.look(shading.toWorld(next.wi));
        result.ownPdf = next.pdfSolidAngle;
        result.radiance = found.radiance;
        next.pdfSolidAngle = view.mixed(result.ownPdf, found.pdf);
        next.weight *= result.ownPdf / next.pdfSolidAngle;
        return result;
    }
};

// The same values as another Bsdf, found by a mixture of its own directions and of others: defensive importance
// sampling [Hesterberg1995]. Weights are eval() over the density of the mixture; those that the Bsdf itself puts on its
// samples count for delta lobes alone, which no other density finds.
class DefensiveBsdf final : public Bsdf {
  public:
    // `own` outlives it. `eta`: index of the side away from the eye over that of the eye's side. `share`: of the even
    // directions, in (0, 1]. With 1 half of the samples are still the Bsdf's own where it has delta lobes beside
    // others, and those of them that are not delta count as nothing. Below 1 a dispersive Bsdf stands as it is: where
    // the hero's density is 0, that of the other wavelengths in the mixture is not known.
    DefensiveBsdf(const Bsdf& own, float eta, float share) : own_(own), eta_(eta), lobes_(own.lobes()) {
        if (!lobes_.any(Lobes(Lobe::diffuse) | Lobe::glossy) || (share < 1 && lobes_.has(Lobe::dispersive))) return;
        mixed_ = share < 1 ? share : lobes_.has(Lobe::delta) ? 0.5f : 1;
        followed_ = share < 1 ? 1 - mixed_ : 0;
    }

    Lobes lobes() const noexcept override { return lobes_; }
    BsdfEval eval(Vec3 wo, Vec3 wi, Transport transport) const noexcept override {
        const BsdfEval e = own_.eval(wo, wi, transport);
        return mixed_ > 0 ? mixed(e) : e;
    }
    std::optional<BsdfSample> sample(Vec3 wo, float uLobe, Vec2 u, Transport transport) const noexcept override {
        if (!(mixed_ > 0)) return own_.sample(wo, uLobe, u, transport);
        if (uLobe >= mixed_)
            return sampleOwn(wo, std::min((uLobe - mixed_) / (1 - mixed_), kOneMinusEpsilon), u, transport);
        const Vec3 wi = EvenDirections::sample(lobes_, wo, u);
        const bool through = wo.z * wi.z < 0;
        Lobes lobe = lobes_.has(Lobe::diffuse) ? Lobe::diffuse : Lobe::glossy;
        lobe |= through ? Lobe::transmission : Lobe::reflection;
        return weighed(mixed(own_.eval(wo, wi, transport)), wi, lobe, through ? eta_ : 1.f);
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
    BsdfEval mixed(BsdfEval e) const {
        e.pdfSolidAngle = mixed_ * EvenDirections::density(lobes_) + followed_ * e.pdfSolidAngle;
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
        return followed_ > 0 ? weighed(mixed(own_.eval(wo, s->wi, transport)), s->wi, s->lobe, s->eta) : std::nullopt;
    }

    const Bsdf& own_;
    float eta_;
    Lobes lobes_;
    float mixed_ = 0, followed_ = 0; // shares of even directions, 0: none, and of own ones that count
};

} // namespace abbe
