#include "spectrum/emission_curves.h"

#include "base/check.h"
#include "spectrum/curve.h"

#include <algorithm>
#include <cmath>

namespace abbe {

double planckRadiance(double nanometres, double kelvin) {
    // Exact SI values [BIPM2019].
    constexpr double h = 6.62607015e-34, c = 299792458, kB = 1.380649e-23;
    const double lambda = nanometres * 1e-9;
    const double perMetre = 2 * h * c * c / (std::pow(lambda, 5) * std::expm1(h * c / (lambda * kB * kelvin)));
    return perMetre * 1e-9;
}

std::unique_ptr<Curve> blackbodyCurve(double kelvin) {
    ABBE_CHECK(kelvin > 0 && std::isfinite(kelvin));
    return std::make_unique<SampledCurve>([kelvin](double nm) { return planckRadiance(nm, kelvin); });
}

std::unique_ptr<Curve> lineCurve(double nanometres) {
    ABBE_CHECK(nanometres >= kMinWavelength && nanometres <= kMaxWavelength);
    return std::make_unique<SampledCurve>([nanometres](double nm) {
        const double share = std::max(0.0, 1 - std::abs(nm - nanometres));
        // The hats of the end nodes are half as wide.
        return nm == kMinWavelength || nm == kMaxWavelength ? 2 * share : share;
    });
}

} // namespace abbe
