// Emission from physical laws.
#pragma once

#include "spectrum/curve.h"
#include "spectrum/spectrum.h"

#include <memory>

namespace abbe {

// Planck's spectral radiance of a black body in vacuum, W·m⁻²·sr⁻¹·nm⁻¹. Requires kelvin > 0.
double planckRadiance(double nanometres, double kelvin);

// Planck's law, absolute, as a 1 nm table. Requires kelvin > 0 and finite.
std::unique_ptr<Curve> blackbodyCurve(double kelvin);

// A spectral line of total 1 (the integral over wavelength in nm): its power is shared by the two nearest nodes of a
// 1 nm table so that total and mean wavelength are kept. Requires nanometres within [360, 830].
std::unique_ptr<Curve> lineCurve(double nanometres);

// Black bodies at the wavelengths of a path, where the temperature changes from point to point.

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
