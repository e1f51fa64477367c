// A function of wavelength: reflectance, radiance, refractive index, …; units are its user's.
#pragma once

#include "spectrum/wavelengths.h"

namespace abbe {

// Immutable after construction; shared between threads.
class Curve {
  public:
    virtual ~Curve() = default;
    virtual Spectrum at(const Wavelengths&) const = 0;
    // One wavelength in nm, clamped to [360, 830].
    virtual double at(double nanometres) const = 0;
    // True if the value is the same at every wavelength (bit for bit).
    virtual bool isConstant() const = 0;
    // Bounds over [360, 830].
    virtual double minimum() const = 0;
    virtual double maximum() const = 0;
};

} // namespace abbe
