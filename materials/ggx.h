// The GGX distribution of microfacet normals [Walter2007], anisotropic, with height-correlated masking and shadowing
// [Heitz2014]. Local frame: +z is the mean normal; wo, wi and m are unit vectors and wo.z >= 0.
//
// Everything is written with the length |(αx x, αy y, z)| of a direction (`stretch`) instead of Smith's
// Λ = (stretch/|z| - 1)/2: then nothing is divided by a cosine, and ratios stay finite down to grazing angles
// (docs/hard_cases.md, cases 24 to 27).
#pragma once

#include "math/vec.h"

namespace abbe {

class Ggx {
  public:
    // Below this width in both directions a lobe is treated as a perfect mirror.
    static constexpr float kSmooth = 5e-4f;
    // Width of the sharper direction when only one of them is below kSmooth.
    static constexpr float kSharpest = 1e-4f;

    // Widths along x and y (α of the literature).
    Ggx(float alphaX, float alphaY) : alphaX_(std::max(alphaX, kSharpest)), alphaY_(std::max(alphaY, kSharpest)) {}

    // α = roughness²; anisotropy 0 … 1 stretches the highlight along x: αy = (1 - anisotropy) αx with the mean square
    // of both kept [Andersson2024].
    static Ggx fromRoughness(float roughness, float anisotropy) {
        const float alpha = roughness * roughness, ratio = 1 - anisotropy;
        const float alphaX = alpha * std::sqrt(2 / (1 + ratio * ratio));
        Ggx g(alphaX, ratio * alphaX);
        g.smooth_ = alphaX < kSmooth && ratio * alphaX < kSmooth;
        return g;
    }

    bool smooth() const { return smooth_; }
    float alphaX() const { return alphaX_; }
    float alphaY() const { return alphaY_; }

    float stretch(Vec3 v) const { return std::sqrt(square(alphaX_ * v.x) + square(alphaY_ * v.y) + v.z * v.z); }

    // Density of normals m (m.z > 0) per solid angle and projected area.
    float D(Vec3 m) const {
        const float slope2 = square(m.x / alphaX_) + square(m.y / alphaY_) + m.z * m.z;
        return 1 / (kPi * alphaX_ * alphaY_ * square(slope2));
    }

    // Density of the normals visible from wo, over D(m) (wo·m): G1(wo)/|wo.z|.
    float visible(Vec3 wo) const { return 2 / (wo.z + stretch(wo)); }

    // G2(wo, wi)/|wo.z|, where wi may lie on either side, wi.z != 0. For transmission, too: why is told in
    // docs/decisions/031-masking-of-transmission.md.
    float maskingOverCosine(Vec3 wo, Vec3 wi) const {
        return 2 / (stretch(wo) + stretch(wi) * (wo.z / std::abs(wi.z)));
    }

    // A normal among those visible from wo, with density visible(wo) D(m) (wo·m) [Dupuy2023].
    Vec3 sampleVisible(Vec3 wo, Vec2 u) const { return sampleCap(wo, u, 1); }

    // The same without most of the normals that would reflect below the horizon [Eto2023; Tokuyoshi2024]; the density
    // of the reflected direction is boundedReflection(wo) D(m).
    Vec3 sampleBounded(Vec3 wo, Vec2 u) const { return sampleCap(wo, u, bound(wo)); }
    float boundedReflection(Vec3 wo) const { return 0.5f / (bound(wo) * wo.z + stretch(wo)); }

  private:
    // Share of the lower part of the cap that can still reflect upwards [Tokuyoshi2024].
    float bound(Vec3 wo) const {
        const float a2 = square(std::min({alphaX_, alphaY_, 1.f}));
        const float s2 = square(1 + std::sqrt(wo.x * wo.x + wo.y * wo.y));
        return (1 - a2) * s2 / (s2 + a2 * wo.z * wo.z);
    }

    Vec3 sampleCap(Vec3 wo, Vec2 u, float share) const {
        const Vec3 i = normalize(Vec3{alphaX_ * wo.x, alphaY_ * wo.y, wo.z});
        const float depth = share * i.z;
        const float z = (1 - u.y) * (1 + depth) - depth;
        const float r = safeSqrt((1 - z) * (1 + z)), phi = 2 * kPi * u.x;
        const Vec3 h{i.x + r * std::cos(phi), i.y + r * std::sin(phi), i.z + z};
        // The floor matters only when the cap point meets -i at grazing incidence.
        return normalize(Vec3{alphaX_ * h.x, alphaY_ * h.y, std::max(h.z, 1e-12f)});
    }

    float alphaX_, alphaY_;
    bool smooth_ = false;
};

// wo mirrored at m.
inline Vec3 reflect(Vec3 wo, Vec3 m) { return m * (2 * dot(wo, m)) - wo; }

// How much of the light one bounce off a GGX surface keeps: the tables behind energy compensation [Turquin2019]. The
// rest would be scattered again by other microfacets; the materials scale their lobes so that it is not lost. Of an
// interface, reflection and transmission are scaled each by its own factor: what one microfacet refracts and another
// stops is often sent back in the end, and both lobes have what light followed from microfacet to microfacet has
// [Heitz2016a].

// Share reflected by a perfectly reflecting surface of width `alpha` (at most 1) seen at cosine mu in [0, 1].
float ggxAlbedo(float mu, float alpha);

// One event at a dielectric interface; T is float or Spectrum.
template <typename T> struct InterfaceShares {
    // Weight of what is reflected against what is transmitted, w in (0, 1): 1/2 where both are scaled alike.
    T turned;
    // 2 w times the share that is reflected plus 2 (1 - w) times the share that is transmitted.
    T kept;

    // Factors of the two parts, which then are all of the light.
    T reflection() const { return turned * 2 / kept; }
    T transmission() const { return (T(1) - turned) * 2 / kept; }
};
// eta: far side over near side; outside [1/10, 10] the nearest end is taken.
InterfaceShares<float> ggxInterface(float mu, float alpha, float eta);

// The layout of the tables, shared with the program that makes them (tools/make_ggx_albedo.cpp).
//
// Single-scattering loss happens near grazing angles and, seen from the dense side, near the critical angle, each over
// a width of α: the coordinate along mu spreads these places out in units of α. T is float or double.
struct GgxAlbedoGrid {
    static constexpr int kMu = 65;
    static constexpr int kMuStep = 4; // InterfaceShares::turned is stored for every fourth only
    static constexpr int kTurnedMu = (kMu - 1) / kMuStep + 1;
    static constexpr int kRoughness = 24; // √α, equal steps from 0 to 1
    static constexpr int kEta = 28; // √((η - 1)/(η + 1)), equal steps; η from 1 to 10, or 1/η for the dense side
    static constexpr double kMaxContrast = 9.0 / 11;
    static constexpr double kMinAlpha = 2e-4;       // below, everything depends on mu/α alone
    static constexpr double kBelowCritical = 0.625; // share of the coordinate given to angles of total reflection
    static constexpr double kNearGrazing = 0.6;     // and of these, to the half near grazing

    template <typename T> static T spread(T t, T alpha) { return t / std::sqrt(t * t + 2 * alpha * alpha); }
    // Position of mu in [0, 1], increasing. criticalMu: cosine of the critical angle, 0 if there is none.
    template <typename T> static T coordinate(T mu, T alpha, T criticalMu) {
        if (criticalMu <= 0) return spread(mu, alpha) / spread(T(1), alpha);
        const T below = T(kBelowCritical), grazing = T(kNearGrazing);
        if (mu >= criticalMu)
            return below + (1 - below) * spread(mu - criticalMu, alpha) / spread(1 - criticalMu, alpha);
        const T whole = spread(criticalMu, alpha);
        return below * (grazing * spread(mu, alpha) + (1 - grazing) * (whole - spread(criticalMu - mu, alpha))) / whole;
    }
};

} // namespace abbe
