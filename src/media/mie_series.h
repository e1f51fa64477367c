// Scattering by one sphere: the series of Lorenz and Mie.
#pragma once

#include <complex>
#include <vector>

namespace abbe {

// Coefficients of the scattered wave, a[n - 1] and b[n - 1] of order n, and what follows from them alone.
struct MieSeries {
    std::vector<std::complex<double>> a, b;
    double extinction = 0, scattering = 0; // efficiencies: cross-sections over π r²
    double asymmetry = 0;                  // mean cosine of scattered light
};

// `size`: circumference over the wavelength around the sphere. `index`: of the sphere relative to its surroundings,
// n + i k with k >= 0. Requires size > 0 and finite, n > 0.
MieSeries mieSeries(double size, std::complex<double> index);
// Largest order that counts for a size.
std::size_t mieOrders(double size);

} // namespace abbe
