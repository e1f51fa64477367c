#include "lights/clear_air.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace abbe {

namespace {

// Density of air over that at sea level, every 5 km [USSA1976]; between them its logarithm is linear.
constexpr double kAirDensity[] = {1,         0.60117,   0.33756,   0.15898,   0.072580,  0.032722,  0.015028,
                                  6.9089e-3, 3.2618e-3, 1.6051e-3, 8.3829e-4, 4.6376e-4, 2.5280e-4, 1.3323e-4,
                                  6.7616e-5, 3.2589e-5, 1.5068e-5, 6.7100e-6, 2.7890e-6, 1.1370e-6, 4.5750e-7};
constexpr double kAirStep = 5;         // km
constexpr double kAerosolHeight = 1.2; // km, within which aerosol thins by e [Bruneton2008]

// Mean cross-sections of ozone in bins of 10 nm from 360 nm, 1e-26 m² [Serdyuchenko2014].
constexpr double kOzoneCrossSections[] = {
    0.118, 0.0218, 0.0282, 0.0664, 0.153, 0.276, 0.552, 0.845, 1.58, 2.32, 3.67, 4.92, 7.75, 9.02, 14.8, 16.0,
    21.4,  27.6,   30.9,   35.0,   42.7,  46.7,  44.0,  47.0,  50.2, 43.1, 37.4, 32.2, 26.6, 22.4, 18.5, 14.7,
    12.1,  9.42,   7.46,   6.57,   5.11,  4.15,  4.23,  3.24,  2.45, 2.80, 2.53, 1.62, 1.47, 2.08, 1.38, 0.711};
constexpr double kDobson = 2.6867e20; // molecules per m²

// Aerosol: [Hess1998, "continental average"] at 550 nm by Lorenz-Mie theory. Its share of scattering, and two lobes
// that are within a third of its phase function from 2° on.
constexpr double kAerosolAlbedo = 0.925;
constexpr double kForwardLobe = 0.72, kBackwardLobe = -0.6, kForwardShare = 0.987; // mean cosine 0.703
constexpr double kDepolarisation = 0.0141; // γ = ρ / (2 - ρ), ρ = 0.028 [Bucholtz1995]
// Of what aerosol scatters, the share that counts as not scattered. With three moments kept no value is right; this
// one comes nearest to random walks with the phase function itself (docs/decisions/030-sky.md).
constexpr double kStraightOn = 0.15;

double airDensity(double height) {
    const double x = height / kAirStep;
    const auto i = std::min(static_cast<std::size_t>(x), std::size(kAirDensity) - 2);
    return std::exp(std::lerp(std::log(kAirDensity[i]), std::log(kAirDensity[i + 1]), x - static_cast<double>(i)));
}
double aerosolDensity(double height) { return std::exp(-height / kAerosolHeight); }
// From 10 to 40 km, most at 25 km [Bruneton2017].
double ozoneDensity(double height) { return std::max(0.0, 1 - std::abs(height - 25) / 15); }

// Moments ∫ P_l dΩ of the phase functions, l up to 3.
double aerosolMoment(int l) {
    return kForwardShare * std::pow(kForwardLobe, l) + (1 - kForwardShare) * std::pow(kBackwardLobe, l);
}
double rayleighMoment(int l) {
    return l == 0 ? 1 : l == 2 ? (1 - kDepolarisation) / (10 * (1 + 2 * kDepolarisation)) : 0;
}

using Boundaries = std::array<double, ClearAir::kShells + 1>;
using Means = std::array<double, ClearAir::kShells>;

// Mean density in each shell over the vertical column, 1/km.
template <typename Density> Means meanDensities(const Boundaries& height, Density density) {
    constexpr int kPoints = 32;
    Means result{};
    double column = 0;
    for (std::size_t shell = 0; shell < result.size(); ++shell) {
        const double thickness = height[shell + 1] - height[shell];
        for (int i = 0; i < kPoints; ++i)
            result[shell] += density(height[shell] + (i + 0.5) / kPoints * thickness) / kPoints;
        column += result[shell] * thickness;
    }
    for (double& mean : result) mean /= column;
    return result;
}

} // namespace

double rayleighDepth(double nm) {
    const double l2 = square(nm * 1e-3); // μm²
    return 0.0021520 * (1.0455996 - 341.29061 / l2 - 0.90230850 * l2) / (1 + 0.0027059889 / l2 - 85.968563 * l2);
}

double aerosolDepth(double nm, double turbidity) { return (0.04608 * turbidity - 0.04586) * std::pow(nm * 1e-3, -1.3); }

double ozoneDepth(double nm, double dobsonUnits) {
    constexpr double last = std::size(kOzoneCrossSections) - 1;
    const double x = std::clamp((nm - 365) / 10, 0.0, last);
    const auto i = std::min(static_cast<std::size_t>(x), std::size(kOzoneCrossSections) - 2);
    return 1e-26 * std::lerp(kOzoneCrossSections[i], kOzoneCrossSections[i + 1], x - static_cast<double>(i)) *
           dobsonUnits * kDobson;
}

float rayleighPhase(float cosine) {
    constexpr double scale = 3 / (16 * kPiD * (1 + 2 * kDepolarisation));
    return static_cast<float>(scale * (1 + 3 * kDepolarisation)) +
           static_cast<float>(scale * (1 - kDepolarisation)) * cosine * cosine;
}

float aerosolPhase(float cosine) {
    const auto lobe = [cosine](float g, float share) {
        const float d = 1 + g * g - 2 * g * cosine;
        return share * (1 - g * g) / (d * std::sqrt(d));
    };
    return (lobe(static_cast<float>(kForwardLobe), static_cast<float>(kForwardShare)) +
            lobe(static_cast<float>(kBackwardLobe), static_cast<float>(1 - kForwardShare))) *
           (0.25f * kInvPi);
}

ClearAir::ClearAir(const AirParams& params) {
    // Thin where the air is dense.
    for (int i = 0; i <= kShells; ++i) height_[static_cast<std::size_t>(i)] = kTop * square(i / double(kShells));
    const Means air = meanDensities(height_, airDensity), haze = meanDensities(height_, aerosolDensity),
                ozone = meanDensities(height_, ozoneDensity);
    for (std::size_t i = 0; i < densities_.size(); ++i) densities_[i] = {air[i], haze[i], ozone[i]};
    const SkyBands molecules = SkyBands::of(rayleighDepth);
    const SkyBands aerosol = SkyBands::of([&](double nm) { return aerosolDepth(nm, params.turbidity); });
    const SkyBands absorber = SkyBands::mean([&](double nm) { return ozoneDepth(nm, params.ozone); });
    for (std::size_t i = 0; i < shells_.size(); ++i) {
        Coefficients& c = shells_[i];
        c.rayleigh = molecules * static_cast<float>(air[i]);
        c.aerosol = aerosol * static_cast<float>(haze[i] * kAerosolAlbedo);
        c.extinction = c.rayleigh + aerosol * static_cast<float>(haze[i] * (1 - kAerosolAlbedo * kStraightOn)) +
                       absorber * static_cast<float>(ozone[i]);
        for (int l = 0; l < 3; ++l)
            c.scatterings[static_cast<std::size_t>(l)] = c.rayleigh * static_cast<float>(rayleighMoment(l)) +
                                                         c.aerosol * static_cast<float>(aerosolMoment(l) - kStraightOn);
    }
}

AirMasses ClearAir::airMasses(double cosine) const {
    AirMasses sum;
    walk(kGroundRadius, 0, cosine, [&](int shell, double t0, double t1) {
        const AirMasses& density = densities_[static_cast<std::size_t>(shell)];
        sum.molecules += density.molecules * (t1 - t0);
        sum.aerosol += density.aerosol * (t1 - t0);
        sum.ozone += density.ozone * (t1 - t0);
    });
    return sum;
}

SkyBands ClearAir::sunlight(double r, int shell, double sunCosine) const {
    const double horizon = std::acos(-safeSqrt(1 - square(kGroundRadius / r)));
    const double above = (horizon - std::acos(std::clamp(sunCosine, -1.0, 1.0))) / kSunHalfAngle;
    if (above <= -1) return SkyBands(0);
    double cosine = sunCosine, share = 1;
    if (above < 1) { // the part of the disk that is seen, and the middle of it
        share = 0.5 + (above * safeSqrt(1 - above * above) + std::asin(above)) / kPiD;
        cosine = std::cos(horizon - kSunHalfAngle * (1 + above) / 2);
    }
    SkyBands depth(0);
    const bool hidden = walk(r, shell, cosine, [&](int s, double t0, double t1) {
        depth = fma(at(s).extinction, static_cast<float>(t1 - t0), depth);
    });
    return hidden ? SkyBands(0) : exp(depth * -1.f) * static_cast<float>(share);
}

} // namespace abbe
