// Cauchy's refractive index: n = a + b / λ² + c / λ⁴, λ in µm.
#pragma once

#include "spectrum/curve.h"

namespace abbe {

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

} // namespace abbe
