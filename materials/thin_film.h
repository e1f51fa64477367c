// Reflectance of an interface that carries a clear film: interference of all reflections inside the film, exact at each
// wavelength [Born1999, §7.6; §14.4 over metals].
#pragma once

#include "materials/complex_spectrum.h"

namespace abbe {

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
