// Sunlight after its way through a clear atmosphere [Preetham1999, appendix A.1; Iqbal1983].
#pragma once

#include "spectrum/sampled_curve.h"

namespace abbe {

// How much air light crosses, 1 from the zenith [Kasten1965]. Requires zenithAngle (rad) in [0, π/2].
double relativeAirMass(double zenithAngle);

// Spectral irradiance on a surface that faces the sun, in W·m⁻²·nm⁻¹ at sea level: Rayleigh scattering, aerosol
// (Ångström, exponent 1.3), ozone (0.35 cm), mixed gases and water vapour (2 cm) take their share. Outside of 380 … 750
// nm the sun itself shines as a black body of 5778 K. Requires turbidity >= 1.
SampledCurve solarIrradiance(double zenithAngle, double turbidity);

} // namespace abbe
