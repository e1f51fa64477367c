// Colours that go to spectra and come back, and lamps with lines.
#pragma once

namespace abbe::doctor {

// Largest error of a component of sRGB over the 27 corners and middles of its cube, of the spectra fitted to them
// (docs/hard_cases.md, case 49).
double rgbRoundTripError();
// Largest relative error of X or Z of FL11, at equal Y, against the sum over single nanometres (case 50).
double lampColourError();
// Largest error of X, Y or Z of light that is 1 everywhere, through the estimator of paths, against (1, 1, 1) of the
// observer's own integrals (case 46).
double equalEnergyError();

} // namespace abbe::doctor
