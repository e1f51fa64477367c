// A surface with glossy lobes, as a LightTree weighs it: eight cones of directions at once.
#pragma once

#include "render/receiver.h"
#include "spectrum/spectrum.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace abbe {

// Refers to the receiver. The arithmetic of spectra serves any eight numbers.
class GlossyReceiver {
  public:
    // Least share that goes by the cosine: the outline is a guess.
    static constexpr float kLeastDiffuse = 0.05f;

    GlossyReceiver(const Receiver&, const ScatterView&);

    const Receiver& at() const { return at_; }
    Vec3 wo() const { return wo_; }
    // Estimate of π times the mean of f |cos θi| over cones. For each, of the direction of its middle: the cosines to
    // the receiver's normal and to wo; sine and square of it, of the cone's half angle; what a matte surface sees.
    Spectrum value(Spectrum cosine, Spectrum cosineWo, Spectrum sine, Spectrum sine2, Spectrum matte) const;

  private:
    // A ball seen under a half angle has 2/9 of its sine² as mean square of the slopes to the points of a cube in it.
    static constexpr float kSpread = 2 / 9.f;
    struct Lobe {
        float scale, alpha2, eta;
    };
    Spectrum lobeValue(const Lobe&, Spectrum cosine, Spectrum cosineWo, Spectrum sine2) const;

    const Receiver& at_;
    Vec3 wo_;
    float cosO_, diffuse_;
    int count_;
    std::array<Lobe, ScatterOutline::kMost> lobes_;
};

inline GlossyReceiver::GlossyReceiver(const Receiver& receiver, const ScatterView& view)
    : at_(receiver), wo_(view.wo), cosO_(std::max(dot(view.wo, receiver.n), 0.f)),
      diffuse_(std::max(view.outline.diffuse, kLeastDiffuse)), count_(view.outline.count) {
    for (int i = 0; i < count_; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const ScatterOutline::Glossy& lobe = view.outline.glossy[k];
        // G1/(4 cos θo) of GGX, see materials/ggx.h.
        const float masked = 0.5f / (cosO_ + std::sqrt(lobe.alpha2 + (1 - lobe.alpha2) * cosO_ * cosO_));
        lobes_[k] = {lobe.share * masked, lobe.alpha2, lobe.eta};
    }
}

// The distribution of microfacets at the half vector of the middle, wo + η wi, made wider by as much as half vectors
// spread over the cone, as [Tokuyoshi2024b] filters it for Gaussians. The Jacobian from half vectors to directions
// [Walter2007, eq. 14 and 17] is that of reflection at the same angle times what follows for refraction.
inline Spectrum GlossyReceiver::lobeValue(const Lobe& lobe, Spectrum cosine, Spectrum cosineWo, Spectrum sine2) const {
    const Spectrum one(1.f), eta(lobe.eta);
    const float eta2 = lobe.eta * lobe.eta;
    const Spectrum length2 = max(fma(cosineWo, Spectrum(2 * lobe.eta), Spectrum(1 + eta2)), Spectrum(1e-6f));
    const Spectrum inverse = one / length2, z = fma(cosine, eta, Spectrum(cosO_));
    const Spectrum cos2 = min(z * z * inverse, one);
    const Spectrum wide2 = fma(sine2 * inverse, Spectrum(kSpread * eta2), Spectrum(lobe.alpha2));
    const Spectrum alpha2 = min(wide2, one), slope = fma(cos2, alpha2 - one, one);
    const Spectrum value = alpha2 * lobe.scale / (slope * slope);
    if (lobe.eta == 1) return value;
    const Spectrum cosines = abs(fma(cosineWo, eta, one) * (cosineWo + eta));
    return value * cosines * (inverse * inverse) * (4 * eta2) / max(wide2, one);
}

inline Spectrum GlossyReceiver::value(Spectrum cosine, Spectrum cosineWo, Spectrum sine, Spectrum sine2,
                                      Spectrum matte) const {
    Spectrum result = matte * diffuse_;
    for (int i = 0; i < count_; ++i) {
        const Lobe& lobe = lobes_[static_cast<std::size_t>(i)];
        const Int8 there = lobe.eta == 1 ? cosine.v > -sine.v : cosine.v < sine.v;
        result += select(there, lobeValue(lobe, cosine, cosineWo, sine2), Spectrum(0.f));
    }
    return result;
}

} // namespace abbe
