// What one bounce off a stretched (anisotropic) surface returns, and at which angles its microfacets reflect: the
// companion of ggxAlbedo and microfacetCosines, which know surfaces of one width only.
#pragma once

#include "materials/stretched_grid.h"
#include "spectrum/spectrum.h"

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
    struct Node {
        Spectrum reflected; // (c - mu)/width at the Gauss points
        float albedo = 0;
    };
    Node integrate(const Ggx&, Vec3 wo) const;
    Spectrum placed(Vec3 wo, Spectrum offset) const;

    StretchedGrid grid_;
    std::unique_ptr<StretchedGrid::Table<Node>> table_;
};

} // namespace abbe
