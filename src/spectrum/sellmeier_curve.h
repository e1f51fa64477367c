// Sellmeier's refractive index: n² - 1 = a + Σ b λ² / (λ² - c), λ² and c in µm².
#pragma once

#include "spectrum/curve.h"

#include <array>
#include <cstddef>
#include <span>

namespace abbe {

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

} // namespace abbe
