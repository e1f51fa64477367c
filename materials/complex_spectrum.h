// Complex numbers at the eight wavelengths of a path, as far as wave optics needs them.
#pragma once

#include "materials/fresnel.h"

namespace abbe {

struct ComplexSpectrum {
    Spectrum re, im;

    ComplexSpectrum operator+(const ComplexSpectrum& b) const { return {re + b.re, im + b.im}; }
    ComplexSpectrum operator-(const ComplexSpectrum& b) const { return {re - b.re, im - b.im}; }
    ComplexSpectrum operator*(const ComplexSpectrum& b) const {
        return {re * b.re - im * b.im, fma(re, b.im, im * b.re)};
    }
    ComplexSpectrum operator*(Spectrum s) const { return {re * s, im * s}; }
    // 0 where b is 0.
    ComplexSpectrum operator/(const ComplexSpectrum& b) const {
        const Spectrum scale = Spectrum(1.f) / max(norm(b), Spectrum(1e-30f));
        return {fma(re, b.re, im * b.im) * scale, (im * b.re - re * b.im) * scale};
    }
    // |z|²
    friend Spectrum norm(const ComplexSpectrum& z) { return fma(z.re, z.re, z.im * z.im); }
    friend ComplexSpectrum square(const ComplexSpectrum& z) { return {(z.re - z.im) * (z.re + z.im), 2 * z.re * z.im}; }
};

// The root with a real and an imaginary part >= 0. Requires z.im >= 0. Of the two parts the larger one is taken from
// the modulus and the other from 2ab = z.im, so that neither cancels.
inline ComplexSpectrum sqrt(const ComplexSpectrum& z) {
    const Spectrum larger = sqrt(0.5f * (hypot(z.re, z.im) + abs(z.re)));
    const Spectrum smaller = 0.5f * z.im / max(larger, Spectrum(1e-20f));
    return {select(z.re.v >= 0.f, larger, smaller), select(z.re.v >= 0.f, smaller, larger)};
}

// exp(2πi t). Absolute error below 2e-7 plus that of t itself.
inline ComplexSpectrum unitPhase(Spectrum turns) {
    const Float8 halves =
        _mm256_round_ps(_mm256_mul_ps(turns.v, _mm256_set1_ps(2.f)), _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
    const Float8 x = 6.283185307f * (turns.v - 0.5f * halves); // [-π/2, π/2]
    const Float8 x2 = x * x;
    // Taylor: the next terms are below 6e-8.
    const Float8 sine =
        x *
        (1.f + x2 * (-1.f / 6 + x2 * (1.f / 120 + x2 * (-1.f / 5040 + x2 * (1.f / 362880 + x2 * (-1.f / 39916800))))));
    const Float8 cosine =
        1.f + x2 * (-0.5f + x2 * (1.f / 24 +
                                  x2 * (-1.f / 720 + x2 * (1.f / 40320 + x2 * (-1.f / 3628800 + x2 / 479001600.f)))));
    // Odd numbers of half turns change the sign; those beyond 2^24 are all even, and as good as any.
    const Float8 odd = halves - 2.f * Float8(_mm256_floor_ps(_mm256_mul_ps(halves, _mm256_set1_ps(0.5f))));
    const Float8 sign = 1.f - 2.f * odd;
    return {Spectrum(cosine * sign), Spectrum(sine * sign)};
}

} // namespace abbe
