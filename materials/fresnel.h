// Reflectance of smooth interfaces between two media for unpolarised light, exact and stable in single precision.
#pragma once

#include "math/vec.h"
#include "spectrum/spectrum.h"

namespace abbe {

// Dielectric interface. `eta`: index of the far side over that of the side the light comes from; cosI in [0, 1] against
// the normal on that side. 1 where reflection is total.
//
// With g = η cos θt = √(η² - 1 + cos²θi), the amplitudes are written as
//     rs = -(η² - 1) / (c + g)²,    rp = (η² - 1)(c - 1/(c + g)) / (η² c + g),
// in which nothing cancels as η -> 1. Just above the critical angle the radicand cancels, so the rounding errors of η²,
// η² - 1 and c² are carried along (docs/hard_cases.md, case 28).
inline Spectrum fresnelDielectric(Spectrum cosI, Spectrum eta) {
    const Spectrum c = cosI, one(1.f), eta2 = eta * eta, shifted = eta2 - one, c2 = c * c;
    const Spectrum lost = fma(eta, eta, -eta2) + (eta2 - (shifted + one));
    const Spectrum contrast = shifted + lost; // η² - 1
    const Spectrum g2 = (shifted + c2) + (lost + fma(c, c, -c2));
    const Spectrum g = sqrt(max(g2, Spectrum(0.f)));
    const Spectrum sum = max(c + g, Spectrum(1e-12f)); // 0 only for η = 1 at grazing incidence, where R = 0
    const Spectrum rs = contrast / (sum * sum);
    const Spectrum rp = contrast * (c - one / sum) / max(eta2 * c + g, Spectrum(1e-12f));
    return select(g2.v < 0.f, one, min((rs * rs + rp * rp) * 0.5f, one));
}
inline Spectrum fresnelDielectric(float cosI, Spectrum eta) { return fresnelDielectric(Spectrum(cosI), eta); }

// The same for one wavelength.
inline float fresnelDielectric(float cosI, float eta) { return fresnelDielectric(Spectrum(cosI), Spectrum(eta))[0]; }

// √(x² + y²) per lane without overflow.
inline Spectrum hypot(Spectrum x, Spectrum y) {
    const Spectrum a = max(abs(x), abs(y)), b = min(abs(x), abs(y));
    const Spectrum ratio = b / max(a, Spectrum(1e-30f));
    return a * sqrt(fma(ratio, ratio, Spectrum(1.f)));
}

// Conductor with complex index n + ik against a medium of index 1; n >= 0, k >= 0, cosI in [0, 1].
//
// a + ib = √((n + ik)² - sin²θ) [Born1999, §14.2]. Of a and b the larger one is taken from the root and the other from
// 2ab = 2nk, and the numerators are sums of squares, so that k ≈ 0 and large k keep their digits (case 29). With n < 1
// and k ≈ 0 there is a critical angle as for dielectrics, where n² - 1 + c² cancels: rounding errors are carried along.
inline Spectrum fresnelConductor(Spectrum cosI, Spectrum n, Spectrum k) {
    const Float8 c = cosI.v, s2 = (1.f - c) * (1.f + c);
    const Float8 twoNk = 2.f * n.v * k.v;
    const Spectrum one(1.f), n2 = n * n, shifted = n2 - one, c2 = cosI * cosI, k2 = k * k;
    const Spectrum lost = (fma(n, n, -n2) + (n2 - (shifted + one))) + (fma(cosI, cosI, -c2) - fma(k, k, -k2));
    const Float8 real = (((shifted + c2) - k2) + lost).v;
    const Float8 modulus = hypot(Spectrum(real), Spectrum(twoNk)).v;
    const Float8 larger = sqrt(Spectrum(0.5f * (modulus + abs(Spectrum(real)).v))).v;
    const Float8 smaller = 0.5f * twoNk / max(Spectrum(larger), Spectrum(1e-20f)).v;
    const Float8 a = select(real >= 0.f, larger, smaller).v;
    const Float8 b = select(real >= 0.f, smaller, larger).v;
    const Float8 b2 = b * b;
    const auto ratio = [](Float8 top, Float8 bottom) { return top / max(Spectrum(bottom), Spectrum(1e-30f)).v; };
    const Float8 rs = ratio((a - c) * (a - c) + b2, (a + c) * (a + c) + b2);
    const Float8 minus = a * c - s2, plus = a * c + s2;
    const Float8 rp = rs * ratio(minus * minus + b2 * (c * c), plus * plus + b2 * (c * c));
    return min(Spectrum(0.5f * (rs + rp)), Spectrum(1.f));
}
inline Spectrum fresnelConductor(float cosI, Spectrum n, Spectrum k) { return fresnelConductor(Spectrum(cosI), n, k); }

} // namespace abbe
