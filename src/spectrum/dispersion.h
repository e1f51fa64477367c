// Refractive indices: formulas as curves, and the conventions of refractiveindex.info.
#pragma once

#include "spectrum/curve.h"

#include <array>
#include <cstddef>
#include <memory>
#include <span>

namespace abbe {

// Cauchy's refractive index: n = a + b / λ² + c / λ⁴, λ in µm.
// Constant beyond [minNm, maxNm].
class CauchyCurve final : public Curve {
  public:
    CauchyCurve(double a, double b, double c = 0, double minNm = kMinWavelength, double maxNm = kMaxWavelength);

    Spectrum at(const Wavelengths& w) const override {
        const Float8 nm = min(max(w.nm, Spectrum(minNm_)), Spectrum(maxNm_)).v;
        const Spectrum inverseSquare(1e6f / (nm * nm));
        const Spectrum slope = fma(Spectrum(static_cast<float>(c_)), inverseSquare, Spectrum(static_cast<float>(b_)));
        return fma(slope, inverseSquare, Spectrum(static_cast<float>(a_)));
    }
    double at(double nanometres) const override;
    bool isConstant() const override { return minimum_ == maximum_; }
    double minimum() const override { return minimum_; }
    double maximum() const override { return maximum_; }

  private:
    double a_, b_, c_;
    float minNm_, maxNm_;
    double minimum_ = 0, maximum_ = 0;
};

// Sellmeier's refractive index: n² - 1 = a + Σ b λ² / (λ² - c), λ² and c in µm².
// Evaluated per lane rather than from a table, so that refraction angles vary smoothly with wavelength. The relative
// error against double arithmetic is below 2e-7. Constant beyond [minNm, maxNm].
class SellmeierCurve final : public Curve {
  public:
    static constexpr std::size_t kMaxTerms = 8;

    // Requires as many strengths b as squared resonance wavelengths c, at most kMaxTerms. A resonance within the
    // wavelengths in use makes the bounds 0 and infinity; usableIndex() rejects such a curve.
    SellmeierCurve(double constant, std::span<const double> strengths, std::span<const double> squaredResonances,
                   double minNm = kMinWavelength, double maxNm = kMaxWavelength);

    Spectrum at(const Wavelengths& w) const override {
        const Float8 nm = min(max(w.nm, Spectrum(minNm_)), Spectrum(maxNm_)).v;
        const Float8 inverseSquare = 1e6f / (nm * nm); // µm⁻²
        Spectrum square(constantPlusOne_);
        for (int i = 0; i < terms_; ++i) {
            const auto k = static_cast<std::size_t>(i);
            square += Spectrum(strength_[k]) / fma(Spectrum(-resonance_[k]), Spectrum(inverseSquare), Spectrum(1.f));
        }
        return sqrt(square);
    }
    double at(double nanometres) const override;
    bool isConstant() const override { return minimum_ == maximum_; }
    double minimum() const override { return minimum_; }
    double maximum() const override { return maximum_; }

  private:
    std::array<double, 2 * kMaxTerms> exact_{}; // b, c, b, c, …
    double constant_ = 0, minimum_ = 0, maximum_ = 0;
    std::array<float, kMaxTerms> strength_{}, resonance_{};
    float constantPlusOne_ = 1, minNm_ = 0, maxNm_ = 0;
    int terms_ = 0;
};

// Refractive index as a formula of wavelength, in the conventions of refractiveindex.info: λ in µm, coefficients in
// the order of that database.

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
