// The ratio of densities in a build in which none depends on wavelength.
#pragma once

#include "spectrum/spectrum.h"

namespace abbe {

// Stands for a Spectrum that is 1 and takes no room and no time.
struct UnitRatio {
    UnitRatio() = default;
    UnitRatio(Spectrum) {}
    operator Spectrum() const { return Spectrum(1.f); }
    UnitRatio operator*(float) const { return {}; }
};

} // namespace abbe
