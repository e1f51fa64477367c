#include "spectrum/cauchy_curve.h"

#include <algorithm>

namespace abbe {

CauchyCurve::CauchyCurve(double a, double b, double c, double minNm, double maxNm)
    : a_(a), b_(b), c_(c), minNm_(static_cast<float>(minNm)), maxNm_(static_cast<float>(maxNm)) {
    minimum_ = maximum_ = at(double{kMinWavelength});
    for (int nm = 361; nm <= 830; ++nm) {
        const double n = at(static_cast<double>(nm));
        minimum_ = std::min(minimum_, n);
        maximum_ = std::max(maximum_, n);
    }
}

double CauchyCurve::at(double nanometres) const {
    const double nm = std::clamp(std::clamp<double>(nanometres, kMinWavelength, kMaxWavelength),
                                 static_cast<double>(minNm_), static_cast<double>(maxNm_));
    const double inverseSquare = 1e6 / (nm * nm);
    return a_ + (b_ + c_ * inverseSquare) * inverseSquare;
}

} // namespace abbe
