// Measurements of numerically hard cases that are quick enough for a user's machine: `abbe doctor --numerics` prints
// them, tests/hard_cases take part in the same functions.
#pragma once

#include <span>

namespace abbe::doctor {

// What the formulas of the renderer take for granted of the machine's arithmetic, in every thread.

// Products whose rounding error std::fma does not give exactly.
double inexactFusedProducts();
// Sums in single and double precision that are not rounded to nearest, ties to even; asked in every worker.
double wrongRoundings();
// Products that are left denormal in a worker of parallelFor (docs/hard_cases.md, case 59).
double denormalsLeft();

// Rays against meshes: none hits the surface that it leaves, none gets through a closed one.

// Of `rays` that leave a convex mesh of 32 000 triangles at all angles, half of them grazing, the share that hits it
// again. The mesh lies `offset` m from the origin. Docs: hard_cases.md, cases 1 and 2. Requires rays > 0.
double selfIntersections(int rays, double offset);
// Of `rays` from inside a closed mesh, all of them aimed at its edges, the number that escapes (case 5).
double escapesAtEdges(int rays);
// The same for its vertices, as a share. Embree decides about each edge by itself, so that where many of them meet all
// faces around a vertex may be missed by a ray that passes it within a rounding. Requires rays > 0.
double escapesAtVertices(int rays);

// Where samples are taken, and how likely that was.

// Largest relative error of the solid angle of cones from 1e-7 rad to π/2, and of the density with which a sphere of
// that size is sampled (docs/hard_cases.md, case 30).
double coneSolidAngleError();
// Largest relative error of the solid angle of triangles, 1e-3 to 1 in size at a distance of 1 (case 31).
double triangleSolidAngleError();
// Bins of weight 0 that tables of weights draw, over all 2²⁴ values of a random number and several tables (case 36).
double emptyBinsDrawn();
// Largest relative error of the probability of dark bins beside one that is 1e9 times brighter (case 34).
double darkBinError();

// Formulas of materials against double precision and textbook forms.

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

// Colours that go to spectra and come back, and lights with lines.

// Largest error of a component of sRGB over the 27 corners and middles of its cube, of the spectra fitted to them
// (docs/hard_cases.md, case 49).
double rgbRoundTripError();
// Largest relative error of X or Z of FL11, at equal Y, against the sum over single nanometres (case 50).
double lineLightColourError();
// Largest error of X, Y or Z of light that is 1 everywhere, through the estimator of paths, against (1, 1, 1) of the
// observer's own integrals (case 46).
double equalEnergyError();

// Sums of samples, and whole renders.

// Relative error of a film's mean after 1e8 samples (docs/hard_cases.md, case 52).
double filmMeanError();
// Of twenty orders of the same terms, those whose exact sum has other bits than the first (case 60).
double orderDependentSums();
// Pixels of a small render that differ between one thread and all of them (case 60).
double threadDependentPixels();

struct NumericCheck {
    int hardCase;         // its number in docs/hard_cases.md; 0: an assumption about the machine
    const char* title;    // what is hard
    const char* measured; // what the number is
    double tolerance;     // the largest value that is good
    double (*measure)();  // deterministic; may use all threads of parallelFor
};

// In the order of their numbers.
std::span<const NumericCheck> numericChecks();

} // namespace abbe::doctor
