// What one bounce off a stretched (anisotropic) surface returns, and at which angles its microfacets reflect: the
// companion of ggxAlbedo and microfacetCosines, which know surfaces of one width only.
#pragma once

#include "math/vec.h"
#include "spectrum/spectrum.h"

#include <array>
#include <memory>

namespace abbe {

// A table over the direction of view for one pair of widths, integrated on construction (about 0.2 s), immutable
// afterwards.
class StretchedLobe {
  public:
    // Widths along x and y, above 0, at most √2.
    StretchedLobe(float alphaX, float alphaY);

    // As those of GgxLobe; wo unit, wo.z >= 0.
    float mirrorAlbedo(Vec3 wo) const;
    Spectrum cosines(Vec3 wo) const;

  private:
    static constexpr int kAzimuths = 13, kMu = 65;
    struct Node {
        Spectrum offset; // (c - mu)/width at the Gauss points
        float albedo = 0;
    };
    struct Place {
        int azimuth, mu;
        float u, v; // within the cell
    };
    // Halfway between the azimuth itself and the angle that the widths make of it: both matter, see StretchedAlbedo.
    float azimuthPosition(Vec3 wo) const;
    float widthTowards(Vec3 wo) const; // α of the profile cut along wo
    Place find(Vec3 wo) const;
    const Node& node(int azimuth, int mu) const { return (*table_)[static_cast<std::size_t>(azimuth * kMu + mu)]; }
    Node integrate(Vec3 wo) const;

    float alphaX_, alphaY_;
    std::unique_ptr<std::array<Node, kAzimuths * kMu>> table_;
};

} // namespace abbe
