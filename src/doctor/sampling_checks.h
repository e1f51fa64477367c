// Where samples are taken, and how likely that was.
#pragma once

namespace abbe::doctor {

// Largest relative error of the solid angle of cones from 1e-7 rad to π/2, and of the density with which a sphere of
// that size is sampled (docs/hard_cases.md, case 30).
double coneSolidAngleError();
// Largest relative error of the solid angle of triangles, 1e-3 to 1 in size at a distance of 1 (case 31).
double triangleSolidAngleError();
// Bins of weight 0 that tables of weights draw, over all 2²⁴ values of a random number and several tables (case 36).
double emptyBinsDrawn();
// Largest relative error of the probability of dark bins beside one that is 1e9 times brighter (case 34).
double darkBinError();

} // namespace abbe::doctor
