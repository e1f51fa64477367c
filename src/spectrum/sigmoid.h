// The reflectance model of [Jakob2019]: a sigmoid of a quadratic polynomial of wavelength. Smooth, and within (0, 1).
#pragma once

#include "spectrum/wavelengths.h"

#include <cmath>

namespace abbe {

// R(λ) = 1/2 + x / (2 √(1 + x²)), x = (c0 t + c1) t + c2 with t = (λ - 595 nm) / 235 nm: in plain nanometres the terms
// of x cancel in float. c2 = ±∞ with c0 = c1 = 0 is exactly white or black.
struct SigmoidCoefficients {
    float c0 = 0, c1 = 0, c2 = 0;

    Spectrum at(const Wavelengths& w) const {
        const Spectrum t((w.nm.v - 595.f) * (1 / 235.f));
        const Spectrum x = fma(fma(Spectrum(c0), t, Spectrum(c1)), t, Spectrum(c2));
        // 1/2 - |x| / (2s) without its cancellation, s = √(1 + x²).
        const Spectrum a = abs(x);
        const Spectrum s = sqrt(fma(a, a, Spectrum(1.f)));
        const Spectrum tail(0.5f / (s.v * (s.v + a.v)));
        return select(x.v < 0.f, tail, Spectrum(1.f) - tail);
    }
};

// The same in double, for fitting and tables.
struct SigmoidCurve {
    double c0 = 0, c1 = 0, c2 = 0;

    double at(double nanometres) const {
        const double t = (nanometres - 595) / 235;
        const double x = (c0 * t + c1) * t + c2, a = std::abs(x), s = std::sqrt(a * a + 1);
        const double tail = 0.5 / (s * (s + a));
        return x < 0 ? tail : 1 - tail;
    }
    // The flat curve of a value in [0, 1].
    static SigmoidCurve flat(double value);
    SigmoidCoefficients coefficients() const {
        return {static_cast<float>(c0), static_cast<float>(c1), static_cast<float>(c2)};
    }
};

} // namespace abbe
