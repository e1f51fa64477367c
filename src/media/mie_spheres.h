// Scattering by spheres of many sizes at one wavelength.
#pragma once

#include <complex>
#include <span>
#include <vector>

namespace abbe {

// Sizes of drops: lognormal, weighed by cross-section.
struct DropSizes {
    double radius = 10e-6; // m, mean weighed by cross-section: the effective radius
    double spread = 0.2;   // standard deviation over the mean, weighed in the same way

    // Radii that stand for equal shares of the cross-section, increasing; `count` of them. The same radius once where
    // there is no spread.
    std::vector<double> radii(std::size_t count) const;
};

struct MieScattering {
    std::vector<double> intensity; // at the angles asked for; its integral over the sphere is `scattering`
    double extinction = 0, scattering = 0, asymmetry = 0; // means over the cross-section, as in MieSeries
};

// `wavelength`: in the surroundings, m. `index` relative to them. Angles in rad.
// Requires: radii > 0, not none; index.real() > 0, index.imag() >= 0.
MieScattering mieScattering(std::span<const double> radii, double wavelength, std::complex<double> index,
                            std::span<const double> angles);

} // namespace abbe
