// What a path carries from vertex to vertex. Members of effects that a scene lacks do not exist.
#pragma once

#include "integrators/surroundings.h"
#include "render/effects.h"
#include "render/receiver.h"
#include "render/surface_hit.h"
#include "spectrum/curve.h"

#include <type_traits>

namespace abbe {

// Effects as a template argument.
using EffectBits = std::uint8_t;

constexpr bool hasEffect(EffectBits bits, Effect e) { return (bits & static_cast<EffectBits>(e)) != 0; }

namespace path_detail {
struct Nothing {};
// Densities of the path so far at each lane's wavelength over that at the hero's: q_j / q_h [Wilkie2014, eq. 5]. The
// estimate divides by their mean; they stay 1 until a density depends on wavelength.
struct SpectralDensities {
    Wavelengths film;             // the wavelengths that the film sees: those at the start of the path
    Spectrum unidirectional{1.f}; // all vertices
    Spectrum before{1.f};         // without the last scattering: what next-event estimation shares
    Spectrum direction{1.f};      // with the last scattering, but without the media on the way from it
    bool heroOnly = false;        // the secondary wavelengths have ended
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
// How wide the path is: a cone about its ray, whose radius grows along the way [Amanatides1984].
struct Cone {
    float radius = 0; // at the start of the segment, m
    float spread = 0; // radius gained per m
};
} // namespace path_detail

template <EffectBits E> struct PathState {
    Wavelengths lambda;
    Spectrum beta{1.f};     // f / q_h: throughput over the hero's density
    Spectrum radiance{0.f}; // estimate of the radiance at the eye, per lane of the film's wavelengths
    Receiver from{Vec3()};  // the last vertex, for the densities of lights
    float bsdfPdf = 1;      // density of the last direction; 1 at the eye
    bool delta = true;      // the last direction came from a delta lobe (or the eye): no other technique finds it
    float time = 0;         // of the whole path, in the shutter interval
    float etaScale = 1;     // what refraction has scaled radiance by, undone for roulette
    [[no_unique_address]] std::conditional_t<hasEffect(E, Effect::dispersion), path_detail::SpectralDensities,
                                             path_detail::Nothing>
        densities;
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
