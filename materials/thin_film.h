// Reflectance of an interface that carries a clear film: interference of all reflections inside the film, exact at each
// wavelength [Born1999, §7.6; §14.4 over metals].
#pragma once

#include "materials/fresnel.h"

namespace abbe {

// Complex numbers at the eight wavelengths of a path, as far as wave optics needs them.

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

// What lies above, in and below the film: refractive indices per lane. Below, n + ik with k >= 0.
struct ThinFilm {
    Spectrum outer, film, n, k;
    Spectrum wavelength; // nm, in vacuum
    float thickness = 0; // nm, >= 0
};

namespace thin_film_detail {

// Films beyond have fringes finer than any surface is flat; between the two the fringes fade into their mean.
inline constexpr float kThick = 5000, kIncoherent = 10000; // nm

// One polarisation: the amplitudes of the two interfaces, and of one way through the film and back. The
// Airy sum, or with `incoherent` > 0 that share of the sum of intensities.
inline Spectrum airy(const ComplexSpectrum& r12, const ComplexSpectrum& r23, const ComplexSpectrum& there,
                     float incoherent) {
    const ComplexSpectrum one{Spectrum(1.f), Spectrum(0.f)}, inside = r23 * there;
    Spectrum result(0.f);
    if (incoherent < 1) {
        const Spectrum bottom = norm(one + r12 * inside);
        // 0/0 only where nothing can enter the film.
        result = select(bottom.v < 1e-14f, Spectrum(1.f), norm(r12 + inside) / max(bottom, Spectrum(1e-14f)));
    }
    if (incoherent > 0) {
        const Spectrum first = min(norm(r12), Spectrum(1.f)), second = norm(inside);
        const Spectrum through = Spectrum(1.f) - first;
        const Spectrum sum = first + through * through * second / max(Spectrum(1.f) - first * second, Spectrum(1e-6f));
        result = result * (1 - incoherent) + sum * incoherent;
    }
    return min(result, Spectrum(1.f));
}

} // namespace thin_film_detail

// Share of unpolarised light that is reflected, from above; cosI in [0, 1] is the angle in the outer medium.
//
// q = n cos θ = √(n² - n₁² sin²θ₁) in each medium. It is imaginary where light would be totally reflected, in the film
// too: the wave then reaches the other side only where the film is thin (docs/hard_cases.md, case 44). As the film
// gets thinner, or its index equal to a neighbour's, this meets the bare interface.
inline Spectrum thinFilmReflectance(Spectrum cosI, const ThinFilm& f) {
    using namespace thin_film_detail;
    const Spectrum zero(0.f), n1 = f.outer;
    const Spectrum s2 = n1 * n1 * max((Spectrum(1.f) - cosI) * (Spectrum(1.f) + cosI), zero);
    const ComplexSpectrum e1{n1 * n1, zero}, e2{f.film * f.film, zero}, e3 = square(ComplexSpectrum{f.n, f.k});
    const ComplexSpectrum q1{n1 * cosI, zero}, q2 = sqrt(e2 - ComplexSpectrum{s2, zero}),
                                               q3 = sqrt(e3 - ComplexSpectrum{s2, zero});
    // Once to and fro: exp(4πi q₂ d / λ).
    const Spectrum length = Spectrum(2 * f.thickness) / f.wavelength;
    ComplexSpectrum there = unitPhase(q2.re * length);
    there = there * exp(q2.im * length * -6.283185307f);
    const float incoherent = std::clamp((f.thickness - kThick) / (kIncoherent - kThick), 0.f, 1.f);
    const Spectrum s = airy((q1 - q2) / (q1 + q2), (q2 - q3) / (q2 + q3), there, incoherent);
    const Spectrum p =
        airy((e2 * q1 - e1 * q2) / (e2 * q1 + e1 * q2), (e3 * q2 - e2 * q3) / (e3 * q2 + e2 * q3), there, incoherent);
    return 0.5f * (s + p);
}

} // namespace abbe
