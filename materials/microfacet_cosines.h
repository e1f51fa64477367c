// At which angles the microfacets of a GGX surface reflect: what it takes to find the share of the light that a lobe
// with *any* Fresnel reflectance returns (its directional albedo), be it that of glass, of a film or of a coated metal.
//
// Of the light that one bounce off a perfect mirror would return, let c(u) be the cosine between direction and
// microfacet below which the share u was reflected. A surface of reflectance F returns ggxAlbedo(mu, alpha) times
//     ∫ F(c(u)) du,
// and eight Gauss points in u are enough.
#pragma once

#include "materials/ggx.h"
#include "math/vec.h"
#include "spectrum/spectrum.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace abbe {

// c at the Gauss points of [0, 1], in the eight lanes, for a surface of width `alpha` (at most √2) seen at cosine mu.
Spectrum microfacetCosines(float mu, float alpha);

// The points, 1/2 ± half the roots of the Legendre polynomial of degree 8, and their weights, whose sum is 1.
inline constexpr Float8 kCosinePoints = {0.0198550718f, 0.1016667613f, 0.2372337950f, 0.4082826788f,
                                         0.5917173212f, 0.7627662050f, 0.8983332387f, 0.9801449282f};
inline constexpr Float8 kCosineWeights = {0.0506142681f, 0.1111905172f, 0.1568533229f, 0.1813418917f,
                                          0.1813418917f, 0.1568533229f, 0.1111905172f, 0.0506142681f};

// The layout of the table, shared with the program that makes it (tools/make_microfacet_cosines.cpp). Positions along
// mu are GgxAlbedoGrid's; stored is (c - mu)/α.
struct MicrofacetCosineGrid {
    static constexpr int kMu = 65;
    static constexpr int kRoughness = 24; // √α, equal steps from 0 to 1
    static constexpr double kScale = 1000;
};

// How light that one microfacet of a GGX surface turns fares among the others: what it takes to find the share that an
// interface with *any* reflectance loses, from what a bare one loses.

// For one direction of view and one index. The microfacets that are hit at a given cosine lie on a circle around wo;
// the means are taken over it, as much of each as wo sees [Heitz2014].
class MicrofacetEscape {
  public:
    // wo unit, wo.z >= 0; eta: far side over near side.
    MicrofacetEscape(const Ggx& ggx, Vec3 wo, Spectrum eta);

    // Of the light that hits microfacets at cosine c in [0, 1], per unit of c: the share that leaves the surface if
    // they reflect all of it, and the share that leaves it if they refract all of it. 0 where they cannot refract.
    struct Shares {
        Spectrum reflected, refracted;
    };
    Shares operator()(Spectrum c) const;

  private:
    struct Direction {
        Spectrum x, y, z;
    };
    // G2/G1 for light that leaves towards wi, wi.z counted positive on its side; 0 where that is negative.
    Spectrum kept(const Direction& wi) const;
    // Of normals, up to a factor.
    Spectrum density(const Direction& m) const;

    Vec3 wo_, up_, side_; // `up_` in the plane of wo and the normal
    float sine_, stretch_;
    float alphaX2_, alphaY2_, narrow_; // α², and 1 - α² of the profile along wo
    float perCircle_;
    bool round_;
    Spectrum eta_;
};

// Integrals over the cosines at which light hits the microfacets of a lobe, for reflectances with critical angles.

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
