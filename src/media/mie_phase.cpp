#include "media/mie_phase.h"

#include "base/parallel.h"
#include "math/vec.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

constexpr double kShortest = 360e-9, kLongest = 830e-9;                                   // m
constexpr double kWavelengthStep = (kLongest - kShortest) / (MiePhase::kWavelengths - 1); // m
constexpr double kWidest = 7e-3;    // rad, between angles of the grid
constexpr double kAccepted = 0.003; // of the integral

// Rings around straight on and straight back are 1/size wide; a spread of sizes blurs all but the first few of them,
// and what is left (bows) is wider than a degree. `finer` divides all steps.
std::vector<double> anglesFor(double size, double spread, double finer) {
    const double fine = std::min(0.35 / size, kWidest) / finer;
    // Where sizes differ by less than a few wavelengths, waves through and past a drop interfere at all angles.
    const bool blurred = spread * size > 20;
    const double widest = blurred ? kWidest / finer : fine;
    const double rings = blurred ? 4 / (spread * size) : kPiD;
    std::vector<double> half{0};
    for (double step = fine; half.back() < kPiD / 2;) {
        if (half.back() > rings) step = std::min(1.05 * step, widest);
        half.push_back(half.back() + step);
    }
    std::vector<double> angles;
    for (const double a : half) angles.push_back(a * (kPiD / 2) / half.back());
    for (std::size_t i = half.size() - 1; i > 0; --i) angles.push_back(kPiD - angles[i - 1]);
    return angles;
}

// How many sizes stand for all: enough that the waves of neighbours do not beat.
std::size_t sizesFor(double size, double spread) {
    return static_cast<std::size_t>(std::clamp(6 * spread * size, 32.0, 256.0));
}

struct Tabulated {
    std::vector<MieScattering> scattering; // of each wavelength
    std::vector<MiePhase::Facts> facts;
    std::vector<std::vector<double>> densities; // of each wavelength, at the nodes of the grid
};

Tabulated tabulate(const MiePhase::Spheres& spheres, std::span<const double> radii, const AngularGrid& grid,
                   std::span<const double> angles) {
    constexpr std::size_t n = MiePhase::kWavelengths;
    Tabulated result{std::vector<MieScattering>(n), std::vector<MiePhase::Facts>(n),
                     std::vector<std::vector<double>>(n)};
    parallelFor(n, [&](std::size_t i) {
        const double wavelength = MiePhase::wavelength(i), nm = wavelength * 1e9;
        const double around = spheres.surroundings ? spheres.surroundings->at(nm) : 1;
        const std::complex<double> index{spheres.index->at(nm), spheres.absorption ? spheres.absorption->at(nm) : 0};
        const MieScattering s = mieScattering(radii, wavelength / around, index / around, angles);
        std::vector<double>& density = result.densities[i] = grid.atNodes(s.intensity);
        const double integral = grid.integral(density);
        for (double& d : density) d /= integral;
        result.facts[i] = {s.extinction, s.scattering, s.asymmetry, grid.firstMoment(density),
                           std::abs(integral / s.scattering - 1)};
    });
    return result;
}

} // namespace

double MiePhase::wavelength(std::size_t i) { return kShortest + kWavelengthStep * static_cast<double>(i); }

MiePhase::MiePhase(const Spheres& spheres) {
    const double around = spheres.surroundings ? spheres.surroundings->at(kShortest * 1e9) : 1;
    const double size = 2 * kPiD * spheres.sizes.radius / kShortest * around;
    const std::vector<double> radii = spheres.sizes.radii(sizesFor(size, spheres.sizes.spread));
    std::vector<double> mean;
    for (double finer = 1; finer <= 4; finer *= 2) {
        const std::vector<double> angles = anglesFor(size, spheres.sizes.spread, finer);
        const AngularGrid grid(angles);
        const Tabulated table = tabulate(spheres, radii, grid, angles);
        facts_ = table.facts;
        const auto worst = std::ranges::max_element(facts_, {}, &Facts::interpolationError);
        if (worst->interpolationError > kAccepted && finer < 4) continue;
        densities_.clear();
        mean.assign(grid.nodes().size(), 0);
        for (std::size_t node = 0; node < mean.size(); ++node)
            for (const std::vector<double>& density : table.densities) {
                densities_.push_back(static_cast<float>(density[node]));
                mean[node] += density[node] / kWavelengths;
            }
        mean_ = std::make_unique<AngularTable>(grid, mean);
        break;
    }
}

// Linear in the cosine and in the wavelength.
Spectrum MiePhase::ratio(float cosine, const Wavelengths& lambda) const noexcept {
    constexpr int n = kWavelengths;
    const AngularTable::Place place = mean_->find(cosine);
    const float whole = mean_->value(place);
    if (!(whole > 0)) return Spectrum(1.f);
    const Float8 position =
        (lambda.nm.v - static_cast<float>(kShortest * 1e9)) * static_cast<float>(1e-9 / kWavelengthStep);
    Int8 cell = __builtin_convertvector(position, Int8);
    cell = cell > n - 2 ? Int8{} + (n - 2) : cell;
    const Spectrum fraction(position - __builtin_convertvector(cell, Float8));
    const float* const row = densities_.data() + static_cast<std::size_t>(place.cell) * kWavelengths;
    const Spectrum low = interpolate(row, cell, fraction), high = interpolate(row + kWavelengths, cell, fraction);
    return fma(high - low, Spectrum(place.fraction), low) / whole;
}

} // namespace abbe
