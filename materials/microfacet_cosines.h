// At which angles the microfacets of a GGX surface reflect: what it takes to find the share of the light that a lobe
// with *any* Fresnel reflectance returns (its directional albedo), be it that of glass, of a film or of a coated metal.
//
// Of the light that one bounce off a perfect mirror would return, let c(u) be the cosine between direction and
// microfacet below which the share u was reflected. A surface of reflectance F returns ggxAlbedo(mu, alpha) times
//     ∫ F(c(u)) du,
// and eight Gauss points in u are enough.
#pragma once

#include "math/vec.h"
#include "spectrum/spectrum.h"

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

} // namespace abbe
