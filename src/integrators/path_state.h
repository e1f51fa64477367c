// What a path carries from vertex to vertex. Members of effects that a scene lacks do not exist.
#pragma once

#include "caustics/glints/glint_plan.h"
#include "integrators/covered_chain.h"
#include "render/effects.h"
#include "render/receiver.h"
#include "render/scatter_outline.h"
#include "render/surface_hit.h"
#include "spectrum/curve.h"
#include "transport/surroundings.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace abbe {

// Effects as a template argument.
using EffectBits = std::uint8_t;

constexpr bool hasEffect(EffectBits bits, Effect e) { return (bits & static_cast<EffectBits>(e)) != 0; }

namespace path_detail {
struct Nothing {
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
};
// How likely a path of light makes this path, against the path from the camera [Veach1997, sec. 10.2]; the notation is
// that of path_loop_traced.h.
struct TracedDensities {
    double odds = 0; // of light paths over camera paths, up to the last vertex; 0: no light path can make it
    Spectrum ahead{1.f}, back{1.f}; // densities at each lane's wavelength over the hero's: of camera and light paths
    Spectrum before{1.f};           // `ahead` without the last scattering
    double scattering = 0;          // density of the last direction for camera paths, 1/sr
    bool first = true;              // no more than one vertex yet
    bool weighs = false;            // odds were not 0 where the path scattered last
    // path_loop_manifold.h
    bool mirrored = true; // nothing but deltas so far
    bool asks = false;    // at a vertex that asked for chains
    CoveredChain chain;   // since then
    Vec3 chainDirection;  // its first direction
    // path_loop_merge.h
    bool gathers = false;  // at a vertex at which merging gathers light
    bool gathered = false; // behind one
    // path_loop_glints.h
    std::span<const std::uint32_t> glintsOfRow; // that may be where the path starts; empty: nothing is left out
    Vec2 film;                                  // where it starts
    GlintChain events;                          // so far
    bool forced = true;                         // all of them as forcedLobe() has them
};
// The curve of absorption of the medium around the present segment; null in air.
struct Interior {
    const Curve* absorption = nullptr;
};
// What the path is in, and what it will be in once it has gone through the surface that it met.
struct Nested {
    Surroundings here, beyond;
    // Where a ray starts that leaves the surface.
    const Surroundings& after(bool throughIt) const { return throughIt ? beyond : here; }
};
// How wide the path is: a cone about its ray, whose radius grows along the way [Amanatides1984]. Mirrors and lenses
// change its spread by the means of the two sections of a narrow beam, which Coddington's equations give
// [Kingslake2010]; `bulge` is the mean curvature of the surface, 1/m, positive where it bulges towards the path.
struct Cone {
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
} // namespace path_detail

template <EffectBits E> struct PathState {
    Wavelengths lambda;
    Spectrum beta{1.f};     // f / q_h: throughput over the hero's density
    Spectrum radiance{0.f}; // estimate of the radiance at the eye, per lane of the film's wavelengths
    Spectrum least{0.f};    // the least of all that was added to it, which the sum does not show
    Receiver from{Vec3()};  // the last vertex, for the densities of lights
    Vec3 origin;            // where its last ray started there
    ScatterView scatters;   // there, if any of its lobes is glossy and lights are chosen by it
    float bsdfPdf = 1;      // density of the last direction; 1 at the eye
    bool delta = true;      // the last direction came from a delta lobe (or the eye): no other technique finds it
    float time = 0;         // of the whole path, in the shutter interval
    float etaScale = 1;     // what refraction has scaled radiance by, undone for roulette
    [[no_unique_address]] std::conditional_t<hasEffect(E, Effect::dispersion), path_detail::SpectralDensities,
                                             path_detail::Nothing>
        densities;
    [[no_unique_address]] std::conditional_t<hasEffect(E, Effect::lightPaths), path_detail::TracedDensities,
                                             path_detail::Nothing>
        traced;
    [[no_unique_address]] std::conditional_t<hasEffect(E, Effect::absorption), path_detail::Interior,
                                             path_detail::Nothing>
        interior;
    [[no_unique_address]] std::conditional_t<hasEffect(E, Effect::interfaces), path_detail::Nested,
                                             path_detail::Nothing>
        nested;
    [[no_unique_address]] std::conditional_t<hasEffect(E, Effect::textures), path_detail::Cone, path_detail::Nothing>
        cone;
};

} // namespace abbe
