// Scattering whose directions are drawn evenly, whatever the surface does: what importance sampling is compared with.
#pragma once

#include "math/warp.h"
#include "render/bsdf.h"

#include <algorithm>
#include <cmath>

namespace abbe {

// The same values as another Bsdf, found by other directions: even over the hemisphere of the eye or, where light is
// let through, over the sphere. Of the Bsdf itself eval() alone is used, except for delta lobes, which no even density
// finds: where there are any beside others, half of the samples are its own, and those of them that are not delta count
// as nothing. All wavelengths share the density.
class UniformBsdf final : public Bsdf {
  public:
    // `own` outlives it. `eta`: index of the side away from the eye over that of the eye's side.
    UniformBsdf(const Bsdf& own, float eta) : own_(own), eta_(eta), lobes_(own.lobes()) {}

    Lobes lobes() const noexcept override { return lobes_; }
    BsdfEval eval(Vec3 wo, Vec3 wi, Transport transport) const noexcept override {
        BsdfEval e = own_.eval(wo, wi, transport);
        e.pdfSolidAngle = evenShare() * density();
        e.pdfRatio = Spectrum(1.f);
        return e;
    }
    std::optional<BsdfSample> sample(Vec3 wo, float uLobe, Vec2 u, Transport transport) const noexcept override {
        const float even = evenShare();
        if (uLobe >= even)
            return sampleDelta(wo, std::min((uLobe - even) / (1 - even), kOneMinusEpsilon), u, transport);
        // The upper hemisphere is the first half of the square.
        Vec3 wi = squareToSphere(lobes_.has(Lobe::transmission) ? u : Vec2{0.5f * u.x, u.y});
        if (wo.z < 0) wi.z = -wi.z;
        const BsdfEval e = own_.eval(wo, wi, transport);
        if (!anyNonZero(e.fcos)) return std::nullopt;
        const bool through = wo.z * wi.z < 0;
        Lobes lobe = lobes_.has(Lobe::diffuse) ? Lobe::diffuse : Lobe::glossy;
        lobe |= through ? Lobe::transmission : Lobe::reflection;
        const float pdf = even * density();
        return std::optional<BsdfSample>(std::in_place, wi, e.fcos / pdf, pdf, lobe, through ? eta_ : 1.f);
    }
    ScatterOutline outline(Vec3 wo) const noexcept override { return own_.outline(wo); }
    // With which the surface itself would have found a direction.
    float ownDensity(Vec3 wo, Vec3 wi) const { return own_.eval(wo, wi, Transport::radiance).pdfSolidAngle; }

  private:
    float evenShare() const {
        if (!lobes_.any(Lobes(Lobe::diffuse) | Lobe::glossy)) return 0;
        return lobes_.has(Lobe::delta) ? 0.5f : 1;
    }
    float density() const { return lobes_.has(Lobe::transmission) ? kSpherePdf : 2 * kSpherePdf; }
    std::optional<BsdfSample> sampleDelta(Vec3 wo, float uLobe, Vec2 u, Transport transport) const {
        auto s = own_.sample(wo, uLobe, u, transport);
        if (!s || !s->lobe.has(Lobe::delta)) return std::nullopt;
        const float share = 1 - evenShare();
        s->weight *= 1 / share;
        s->pdfSolidAngle *= share;
        return s;
    }

    const Bsdf& own_;
    float eta_;
    Lobes lobes_;
};

} // namespace abbe
