// What a path carries from vertex to vertex. Members of effects that a scene lacks do not exist.
#pragma once

#include "render/effects.h"
#include "spectrum/curve.h"
#include "spectrum/spectrum.h"
#include "transport/solid_walk.h"
#include "transport/surroundings.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace abbe {

// Effects as a template argument.
using EffectBits = std::uint8_t;

constexpr bool hasEffect(EffectBits bits, Effect e) { return (bits & static_cast<EffectBits>(e)) != 0; }

// What a path has of effects that its scene lacks.
struct NoState {
    static constexpr bool left() { return false; } // see MediaState
};

// Densities of the path so far at each lane's wavelength over that at the hero's: q_j / q_h [Wilkie2014, eq. 5]. The
// estimate divides by their mean; they stay 1 until a density depends on wavelength.
struct SpectralDensities {
    Wavelengths film;             // the wavelengths that the film sees: those at the start of the path
    Spectrum unidirectional{1.f}; // all vertices
    Spectrum before{1.f};         // without the last scattering: what next-event estimation shares
    Spectrum direction{1.f};      // with the last scattering, but without the media on the way from it
    bool heroOnly = false;        // the secondary wavelengths have ended
    bool parted = false;          // by a delta that disperses, whether they had ended before or not
};

// The curve of absorption of the medium around the present segment; null in air.
struct AbsorbingInterior {
    const Curve* absorption = nullptr;
};

// What the path is in, and what it will be in once it has gone through the surface that it hit.
struct NestedDielectrics {
    Surroundings here, beyond;
    // Where a ray starts that leaves the surface.
    const Surroundings& after(bool throughIt) const { return throughIt ? beyond : here; }
};

// How wide the path is: a cone about its ray, whose radius grows along the way [Amanatides1984]. Mirrors and lenses
// change its spread by the means of the two sections of a narrow beam, which Coddington's equations give
// [Kingslake2010]; `bulge` is the mean curvature of the surface, 1/m, positive where it bulges towards the path.
struct RayCone {
    float radius = 0; // at the start of the segment, m
    float spread = 0; // radius gained per m; negative towards a focus

    void advance(float distance) {
        radius += spread * distance;
        if (radius < 0) { // past the focus
            radius = -radius;
            spread = -spread;
        }
    }
    void reflect(float bulge, float cosine) { spread += radius * bulge * (cosine + 1 / std::max(cosine, kGrazing)); }
    // eta: index beyond over that of where the path comes from.
    void refract(float bulge, float eta, float cosine) {
        const float here = std::max(cosine, kGrazing);
        const float beyond = std::sqrt(std::max(1 - (1 - here * here) / (eta * eta), kGrazing * kGrazing));
        const float power = radius * bulge * (beyond - here / eta);
        spread = 0.5f * (spread / eta * (1 + here / beyond) - power * (1 + 1 / (here * beyond)));
        radius *= 0.5f * (1 + beyond / here);
    }

  private:
    static constexpr float kGrazing = 0.05f; // smaller cosines would widen it without an end
};

// Of one path, whichever end it started from.
template <EffectBits E> struct PathState {
    template <Effect effect, typename State> using With = std::conditional_t<hasEffect(E, effect), State, NoState>;

    Wavelengths lambda;
    Spectrum beta{1.f}; // f / q_h: throughput over the hero's density
    float bsdfPdf = 1;  // density of the last direction; 1 at the eye
    float ownPdf = 0;   // of directions drawn evenly: the density that surface or medium would have; else 0
    bool delta = true;  // the last direction came from a delta lobe (or the eye): no other technique finds it
    bool scatteredInMedium = false; // somewhere on the way
    float time = 0;                 // of the whole path, in the shutter interval
    float etaScale = 1;             // what refraction has scaled radiance by, undone for roulette
    [[no_unique_address]] With<Effect::dispersion, SpectralDensities> densities;
    [[no_unique_address]] With<Effect::absorption, AbsorbingInterior> interior;
    [[no_unique_address]] With<Effect::interfaces, NestedDielectrics> nested;
    [[no_unique_address]] With<Effect::textures, RayCone> cone;
    [[no_unique_address]] With<Effect::media, SurfacePull> pull;
};

} // namespace abbe
