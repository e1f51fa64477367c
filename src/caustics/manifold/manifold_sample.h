// Light that small sources send to a point through glass or by mirrors.
#pragma once

#include "math/vec.h"
#include "spectrum/spectrum.h"

#include <cstdint>

namespace abbe {

class Light;

struct ManifoldSample {
    Vec3 wi; // unit, from the receiver towards the first interface
    // W·m⁻²·nm⁻¹ on a surface that faces wi: what f(wo, wi) |cos θ| or a phase function is to be multiplied with. All
    // densities are divided out.
    Spectrum irradiance{0.f};
    // Of the chain, by the lamp as a path that meets it would see it: with the irradiance above the second moment that
    // chance would have in place of this. 0 for lights that nobody meets by chance.
    Spectrum radiance{0.f};
    const Light* light = nullptr;
    int length = 0; // interfaces on the way
    // The chain refracts where indices vary with wavelength: it is that of the hero alone. Lane 0 then counts for all
    // of them, eightfold, and the others are 0 (as PathWalk::endSecondaryWavelengths; divide by the hero's own ratio of
    // densities there).
    bool heroOnly = false;
    bool capped = false; // trials ended before the solution came back: `irradiance` is too low in the mean
};

} // namespace abbe
