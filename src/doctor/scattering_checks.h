// Formulas of materials against double precision and textbook forms.
#pragma once

namespace abbe::doctor {

// Largest absolute error of the reflectance of dielectrics, for η within 1e-6 … 1.4 of 1 and all angles, many of them
// next to the critical one (docs/hard_cases.md, case 28).
double fresnelDielectricError();
// The same for |η - 1| > 0.01 alone.
double fresnelDielectricErrorApart();
// Largest absolute error of the reflectance of conductors, k from 1e-8 to 1e5 (case 29).
double fresnelConductorError();
// Largest relative error of the GGX density about its peak, α from 1e-4 to 1 (case 24).
double ggxDensityError();
// Largest difference between a film of no thickness and none at all (case 44).
double emptyFilmError();
// Largest |b1·b2| and |b·n| of frames about normals of all signs and sizes of components (case 12).
double frameError();

} // namespace abbe::doctor
