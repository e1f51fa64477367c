// Integrals over the cosines at which light meets the microfacets of a lobe, for reflectances with critical angles.
#pragma once

#include "materials/microfacet_cosines.h"
#include "materials/microfacet_escape.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace abbe {

// Cosine up to which an interface reflects totally, the lowest of all lanes; 0 if it does not. eta: far side over near
// side.
inline float criticalCosine(Spectrum eta) {
    const float e = maxLane(eta);
    return e < 1 ? std::sqrt((1 - e) * (1 + e)) : 0;
}

// Gauss points, dense where most of the light is and beyond each critical angle, where reflectances fall like the root
// of the distance.
class MetCosines {
  public:
    using Kinks = std::array<float, 4>;
    // lobe: see microfacetCosines(), which away from grazing angles knows that a narrow one is narrow, but not how
    // much; spread: standing for that, α times the sine. `from`: of the integral; kinks: critical cosines in it, in any
    // order, others do not matter; `fine`: more points where there are none.
    MetCosines(Spectrum lobe, float spread, float from, Kinks kinks, bool fine);

    // Integrals over the cosine of f times the shares that leave the surface. `varies`: f differs between the lanes for
    // reasons of its own; `disperses`: the shares do.
    template <typename F>
    MicrofacetEscape::Shares integral(F&& f, const MicrofacetEscape& escape, bool varies, bool disperses) const {
        MicrofacetEscape::Shares sum{Spectrum(0.f), Spectrum(0.f)};
        const auto add = [&](Spectrum value, const MicrofacetEscape::Shares& s) {
            sum.reflected += value * s.reflected;
            sum.refracted += value * s.refracted;
        };
        for (std::size_t block = 0; block < count_; ++block) {
            const Spectrum &c = cosines_[block], &step = steps_[block];
            const MicrofacetEscape::Shares all = escape(c); // the lanes take eight cosines
            if (!varies && !disperses) {
                const Spectrum value = f(c) * step;
                sum.reflected += Spectrum(abbe::sum(value * all.reflected));
                sum.refracted += Spectrum(abbe::sum(value * all.refracted));
                continue;
            }
            for (int i = 0; i < kLanes; ++i) {
                const Spectrum at(c[i]);
                add(f(at) * step[i],
                    disperses ? escape(at)
                              : MicrofacetEscape::Shares{Spectrum(all.reflected[i]), Spectrum(all.refracted[i])});
            }
        }
        return sum;
    }

  private:
    void addInterval(float from, float to, bool critical, int blocks);

    float middle_, width_; // of the lobe
    std::size_t count_ = 0;
    std::array<Spectrum, 10> cosines_, steps_;
};

} // namespace abbe
