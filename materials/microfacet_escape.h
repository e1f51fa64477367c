// How light that one microfacet of a GGX surface turns fares among the others: what it takes to find the share that an
// interface with *any* reflectance loses, from what a bare one loses.
#pragma once

#include "materials/ggx.h"
#include "spectrum/spectrum.h"

namespace abbe {

// For one direction of view and one index. The microfacets that are met at a given cosine lie on a circle around wo;
// the means are taken over it, as much of each as wo sees [Heitz2014].
class MicrofacetEscape {
  public:
    // wo unit, wo.z >= 0; eta: far side over near side.
    MicrofacetEscape(const Ggx& ggx, Vec3 wo, Spectrum eta);

    // Of the light that meets microfacets at cosine c in [0, 1], per unit of c: the share that leaves the surface if
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

} // namespace abbe
