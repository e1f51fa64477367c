#include "spectrum/sellmeier_curve.h"

#include "base/check.h"
#include "math/vec.h"

#include <algorithm>
#include <cmath>

namespace abbe {

SellmeierCurve::SellmeierCurve(double constant, std::span<const double> strengths,
                               std::span<const double> squaredResonances, double minNm, double maxNm)
    : constant_(constant), constantPlusOne_(static_cast<float>(1 + constant)), minNm_(static_cast<float>(minNm)),
      maxNm_(static_cast<float>(maxNm)), terms_(static_cast<int>(strengths.size())) {
    ABBE_CHECK(strengths.size() == squaredResonances.size() && strengths.size() <= kMaxTerms);
    bool resonant = false;
    const double low = std::max<double>(minNm_, kMinWavelength), high = std::min<double>(maxNm_, kMaxWavelength);
    for (std::size_t i = 0; i < strengths.size(); ++i) {
        exact_[2 * i] = strengths[i];
        exact_[2 * i + 1] = squaredResonances[i];
        strength_[i] = static_cast<float>(strengths[i]);
        resonance_[i] = static_cast<float>(squaredResonances[i]);
        const double c = squaredResonances[i] * 1e6; // nm²
        resonant |= strengths[i] != 0 && c >= square(low - 1) && c <= square(high + 1);
    }
    minimum_ = maximum_ = at(double{kMinWavelength});
    for (int nm = 361; nm <= 830; ++nm) {
        const double n = at(static_cast<double>(nm));
        resonant |= !std::isfinite(n);
        minimum_ = std::min(minimum_, n);
        maximum_ = std::max(maximum_, n);
    }
    if (resonant || !std::isfinite(minimum_)) {
        minimum_ = 0;
        maximum_ = HUGE_VAL;
    }
}

double SellmeierCurve::at(double nanometres) const {
    const double nm = std::clamp(std::clamp<double>(nanometres, kMinWavelength, kMaxWavelength),
                                 static_cast<double>(minNm_), static_cast<double>(maxNm_));
    const double lambda2 = nm * nm * 1e-6;
    double n2 = 1 + constant_;
    for (std::size_t i = 0; i < static_cast<std::size_t>(terms_); ++i)
        n2 += exact_[2 * i] * lambda2 / (lambda2 - exact_[2 * i + 1]);
    return std::sqrt(n2);
}

} // namespace abbe
