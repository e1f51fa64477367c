// Scattering at a point inside a medium: how much goes where.
#pragma once

#include "spectrum/spectrum.h"

namespace abbe {

// Rotationally symmetric about the direction in which light travels. Immutable, thread-safe. `cosine` is that of the
// angle between the directions of travel before and after: 1 goes straight on.
class PhaseFunction {
  public:
    virtual ~PhaseFunction() = default;
    // Density over the sphere, 1/sr; its integral is 1.
    virtual float value(float cosine) const noexcept = 0;
    // A cosine whose direction, with an azimuth drawn evenly, has exactly the density value(). u in [0, 1).
    virtual float sampleCosine(float u) const noexcept = 0;
    // True if scattering depends on wavelength: then directions are drawn from value(), one density for all, and
    // weighed by ratio().
    virtual bool spectral() const { return false; }
    // Density at each wavelength over value(); its mean over the sphere, weighed by value(), is 1. Finite.
    virtual Spectrum ratio(float, const Wavelengths&) const noexcept { return Spectrum(1.f); }
};

} // namespace abbe
