// Matte surfaces of rough grains: the energy-preserving Oren-Nayar model [Portsmouth2025], in which white keeps all
// light at every roughness. Reciprocal.
//
// The factor of the compensating term is the one for which that holds; the published formula divides it by another π.
#pragma once

#include "math/vec.h"
#include "spectrum/spectrum.h"

namespace abbe {

class EonDiffuse {
  public:
    // Colour of the single grain, 0 … 1; roughness 0 (Lambert) … 1.
    EonDiffuse(const Spectrum& color, float roughness)
        : color_(color), roughness_(roughness < kLeast ? 0 : roughness), a_(1 / (1 + kSlope * roughness_)),
          b_(roughness_ * a_) {
        if (roughness_ == 0) return;
        const float average = a_ * (1 + (2.f / 3 - 28 / (15 * kPi)) * roughness_);
        const Spectrum lost(1 - average);
        multiple_ = color * color * (average / (1 - average)) / (Spectrum(1.f) - color * lost);
    }

    // f(wo, wi), 1/sr. Requires wo.z > 0 and wi.z > 0.
    Spectrum operator()(Vec3 wo, Vec3 wi) const {
        if (roughness_ == 0) return color_ * kInvPi;
        const float s = dot(wo, wi) - wo.z * wi.z, t = s > 0 ? std::max(wo.z, wi.z) : 1;
        const Spectrum once = color_ * (a_ + b_ * s / t);
        return (once + multiple_ * ((1 - singleAlbedo(wo.z)) * (1 - singleAlbedo(wi.z)))) * kInvPi;
    }

    // Share of the light from a direction of cosine mu in [0, 1] that is reflected.
    Spectrum albedo(float mu) const {
        if (roughness_ == 0) return color_;
        const float once = singleAlbedo(mu), average = a_ * (1 + (2.f / 3 - 28 / (15 * kPi)) * roughness_);
        return color_ * once + multiple_ * ((1 - once) * (1 - average));
    }

  private:
    static constexpr float kSlope = 0.5f - 2 / (3 * kPi);
    static constexpr float kLeast = 1e-6f; // what less takes from the single reflection is lost in rounding

    // Of white grains, after one reflection: a + (b/π) G(μ), where G → 0.66 as μ → 0 [Portsmouth2025, eq. 17]. With
    // sine = S, S/μ (1 - S³) is written so that nothing cancels: 1 - S³ = μ² (1 + S + S²)/(1 + S).
    float singleAlbedo(float mu) const {
        const float c = std::clamp(mu, 0.f, 1.f), sine = safeSqrt((1 - c) * (1 + c));
        const float rest = sine * c * (1 + sine + sine * sine) / (1 + sine);
        const float g = sine * (std::acos(c) - sine * c) + 2.f / 3 * (rest - sine);
        return a_ + b_ * kInvPi * g;
    }

    Spectrum color_, multiple_; // multiple_: the factor of the compensating term
    float roughness_, a_, b_;
};

} // namespace abbe
