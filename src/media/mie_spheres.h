// Scattering by spheres: of one by the series of Lorenz and Mie, and of many sizes at one wavelength.
#pragma once

#include <complex>
#include <span>
#include <vector>

namespace abbe {

// Scattering by one sphere. Coefficients of the scattered wave, a[n - 1] and b[n - 1] of order n, and what follows from
// them alone.
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

// Sizes of drops: lognormal, weighed by cross-section.
struct DropSizes {
    double radius = 10e-6; // m, mean weighed by cross-section: the effective radius
    double spread = 0.2;   // standard deviation over the mean, weighed in the same way

    // Radii that stand for equal shares of the cross-section, increasing; `count` of them. The same radius once where
    // there is no spread.
    std::vector<double> radii(std::size_t count) const;
};

// Scattering by spheres of many sizes at one wavelength.
struct MieScattering {
    std::vector<double> intensity; // at the angles asked for; its integral over the sphere is `scattering`
    double extinction = 0, scattering = 0, asymmetry = 0; // means over the cross-section, as in MieSeries
};

// `wavelength`: in the surroundings, m. `index` relative to them. Angles in rad.
// Requires: radii > 0, not none; index.real() > 0, index.imag() >= 0.
MieScattering mieScattering(std::span<const double> radii, double wavelength, std::complex<double> index,
                            std::span<const double> angles);

} // namespace abbe
