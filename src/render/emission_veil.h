// What light passes on its way out of a surface that gives it off: a coat, fuzz.
#pragma once

#include "spectrum/spectrum.h"

namespace abbe {

// Immutable, thread-safe; the same all over the surface.
class EmissionVeil {
  public:
    virtual ~EmissionVeil() = default;
    // Share, 0 … 1, of the light that leaves at an angle of this cosine in [0, 1] to the geometric normal.
    virtual Spectrum passing(float cosine, const Wavelengths&) const noexcept = 0;
};

} // namespace abbe
