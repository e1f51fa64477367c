// The sun's spectrum, outside of the air and after its way through it.
#pragma once

#include "lights/clear_air.h"
#include "spectrum/curve.h"

namespace abbe {

// How much air light crosses, 1 from the zenith [Kasten1965]. Requires zenithAngle (rad) in [0, π/2].
double relativeAirMass(double zenithAngle);

// Spectral irradiance on a surface that faces the sun outside of the air, W·m⁻²·nm⁻¹ [ASTMG173].
double solarIrradianceInSpace(double nm);

// What mixed gases and 2 cm of water vapour leave of light after so much air [Iqbal1983]: bands that begin at 690 nm.
double gasTransmittance(double nm, double airMass);

// Spectral irradiance on a surface that faces the sun, at sea level, W·m⁻²·nm⁻¹; 0 where its middle is below the
// horizon. Air and aerosol scatter their share away, aerosol, ozone and gases absorb theirs. Requires zenithAngle (rad)
// in [0, π].
SampledCurve solarIrradiance(double zenithAngle, const AirParams&);

} // namespace abbe
