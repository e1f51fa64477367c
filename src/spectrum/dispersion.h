// Refractive index as a formula of wavelength, in the conventions of refractiveindex.info: λ in µm, coefficients in
// the order of that database.
#pragma once

#include "spectrum/curve.h"

#include <memory>
#include <span>

namespace abbe {

enum class DispersionFormula {
    sellmeier = 1,           // n² - 1 = c0 + Σ b λ² / (λ² - c²)
    sellmeierSquared = 2,    // n² - 1 = c0 + Σ b λ² / (λ² - c)
    polynomial = 3,          // n² = c0 + Σ b λ^c
    refractiveIndexInfo = 4, // n² = c0 + two terms b λ^p / (λ² - c^q) + Σ d λ^r
    cauchy = 5,              // n = c0 + Σ b λ^c
};

struct Dispersion {
    DispersionFormula formula = DispersionFormula::sellmeierSquared;
    std::span<const double> coefficients;                  // must outlive the struct
    double minNm = kMinWavelength, maxNm = kMaxWavelength; // where the formula holds
};

// The index at one wavelength, constant beyond the range of the formula; NaN where the formula has no real value.
double index(const Dispersion&, double nanometres);

// The fastest exact curve for the formula; a 1 nm table where none exists. Check the result with usableIndex().
std::unique_ptr<Curve> makeIndexCurve(const Dispersion&);

// True if the index of refraction lies within (0.2, 10) everywhere, without resonances among the wavelengths in use.
// A dielectric needs that; metals do not.
bool usableIndex(const Curve&);

} // namespace abbe
