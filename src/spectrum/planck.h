// Black bodies at the wavelengths of a path, where the temperature changes from point to point.
#pragma once

#include "spectrum/wavelengths.h"

namespace abbe {

// Below this, in K, a black body sends out less than 1e-13 of what it does at 1900 K at any wavelength rendered.
inline constexpr float kColdest = 400;

// Planck's spectral radiance, W·m⁻²·sr⁻¹·nm⁻¹, to about 1e-5; 0 below kColdest and for NaN. Requires:
// kelvin finite.
inline Spectrum planckRadiance(const Wavelengths& lambda, float kelvin) noexcept {
    if (!(kelvin > kColdest)) return Spectrum(0.f);
    constexpr float kFirst = 1.191042972e20f; // 2hc² in W·nm⁴/(m²·sr)
    constexpr float kSecond = 1.438776877e7f; // hc/k in nm·K
    const Spectrum inverse(1.f / lambda.nm.v), squared = inverse * inverse;
    const Spectrum x = inverse * (kSecond / kelvin), e = exp(-x);
    // 1 - e^-x, by its series where the difference would lose its digits.
    const Spectrum series = x * fma(x, fma(x, Spectrum(1 / 6.f), Spectrum(-0.5f)), Spectrum(1.f));
    return squared * squared * inverse * e * kFirst / select(x.v < 0.02f, series, Spectrum(1.f) - e);
}

} // namespace abbe
