// How much of the light one bounce off a GGX surface keeps: the tables behind energy compensation [Turquin2019]. The
// rest would be scattered again by other microfacets; the materials scale their lobes so that it is not lost. Of an
// interface, reflection and transmission are scaled each by its own factor: what one microfacet refracts and another
// stops is often sent back in the end, and both lobes have what light followed from microfacet to microfacet has
// [Heitz2016a].
#pragma once

#include "math/vec.h"

namespace abbe {

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
