// Emission from physical laws.
#pragma once

#include "spectrum/curve.h"

#include <memory>

namespace abbe {

// Planck's spectral radiance of a black body in vacuum, W·m⁻²·sr⁻¹·nm⁻¹. Requires kelvin > 0.
double planckRadiance(double nanometres, double kelvin);

// Planck's law, absolute, as a 1 nm table. Requires kelvin > 0 and finite.
std::unique_ptr<Curve> blackbodyCurve(double kelvin);

// A spectral line of total 1 (the integral over wavelength in nm): its power is shared by the two nearest nodes of a
// 1 nm table so that total and mean wavelength are kept. Requires nanometres within [360, 830].
std::unique_ptr<Curve> lineCurve(double nanometres);

} // namespace abbe
