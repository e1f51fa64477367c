// The air of a cloudless day: what it is made of at each height, and what that does to light.
#pragma once

#include "math/vec.h"
#include "spectrum/spectrum.h"

#include <algorithm>
#include <array>

namespace abbe {

// Values at the sixteen wavelengths at which the light of the sky is computed, evenly from 360 to 830 nm; arithmetic is
// per band.
struct SkyBands {
    static constexpr int kCount = 2 * kLanes;
    static constexpr double kStep = double(kMaxWavelength - kMinWavelength) / (kCount - 1); // nm
    static double wavelength(int i) { return double(kMinWavelength) + i * kStep; }          // nm

    Spectrum low, high; // the eight of short wavelengths, and those of long

    SkyBands() = default;
    explicit SkyBands(float s) : low(s), high(s) {}
    SkyBands(Spectrum l, Spectrum h) : low(l), high(h) {}
    // f(nm) at each. What has structure between them is better averaged: see mean().
    template <typename F> static SkyBands of(F f) {
        SkyBands result;
        for (int i = 0; i < kLanes; ++i) {
            result.low.v[i] = static_cast<float>(f(wavelength(i)));
            result.high.v[i] = static_cast<float>(f(wavelength(i + kLanes)));
        }
        return result;
    }
    // The means of f(nm) under the hats of linear interpolation, cut off at both ends.
    template <typename F> static SkyBands mean(F f) {
        return of([&](double nm) {
            constexpr int kPoints = 16;
            double sum = 0, weights = 0;
            for (int i = -kPoints + 1; i < kPoints; ++i) {
                const double at = nm + i * kStep / kPoints, weight = 1 - std::abs(i) / double(kPoints);
                if (at < double(kMinWavelength) || at > double(kMaxWavelength)) continue;
                sum += weight * f(at);
                weights += weight;
            }
            return sum / weights;
        });
    }

    double operator[](int i) const { return static_cast<double>(i < kLanes ? low[i] : high[i - kLanes]); }
    SkyBands operator+(const SkyBands& b) const { return {low + b.low, high + b.high}; }
    SkyBands operator-(const SkyBands& b) const { return {low - b.low, high - b.high}; }
    SkyBands operator*(const SkyBands& b) const { return {low * b.low, high * b.high}; }
    SkyBands operator/(const SkyBands& b) const { return {low / b.low, high / b.high}; }
    SkyBands operator*(float s) const { return {low * s, high * s}; }
    SkyBands& operator+=(const SkyBands& b) { return *this = *this + b; }

    // Linear in wavelength between the bands.
    double at(double nm) const {
        const double x = (nm - double(kMinWavelength)) / kStep;
        const int i = std::clamp(static_cast<int>(x), 0, kCount - 2);
        return std::lerp((*this)[i], (*this)[i + 1], x - i);
    }
    Spectrum at(const Wavelengths& w) const noexcept {
        const Float8 x = (w.nm.v - kMinWavelength) * static_cast<float>(1 / kStep);
        Int8 i = __builtin_convertvector(x, Int8);
        i = i > kCount - 2 ? Int8{} + (kCount - 2) : i;
        const auto value = [&](Int8 k) {
            const __m256i lane = reinterpret_cast<__m256i>(k);
            return select(k < kLanes, Spectrum(_mm256_permutevar8x32_ps(low.v, lane)),
                          Spectrum(_mm256_permutevar8x32_ps(high.v, lane)));
        };
        const Spectrum a = value(i), b = value(i + 1);
        return fma(b - a, Spectrum(x - __builtin_convertvector(i, Float8)), a);
    }
};

inline SkyBands fma(const SkyBands& a, const SkyBands& b, const SkyBands& c) {
    return {fma(a.low, b.low, c.low), fma(a.high, b.high, c.high)};
}
inline SkyBands fma(const SkyBands& a, float s, const SkyBands& c) {
    const Spectrum b(s);
    return {fma(a.low, b, c.low), fma(a.high, b, c.high)};
}
inline SkyBands exp(const SkyBands& a) { return {exp(a.low), exp(a.high)}; }

inline constexpr double kSunHalfAngle = 0.265 * kPiD / 180; // of the sun's disk

// The haze and the ozone of a day.
struct AirParams {
    double turbidity = 3; // 1: no aerosol; see aerosolDepth()
    double ozone = 300;   // Dobson units
};

// Optical depths of a vertical way through all of the air, by wavelength in nm.
// Molecules, at 1013.25 hPa [Bodhaine1999, eq. 30].
double rayleighDepth(double nm);
// Aerosol: Ångström's law with exponent 1.3 and, as [Preetham1999, appendix A.1] has it, a coefficient of
// 0.04608 T - 0.04586.
double aerosolDepth(double nm, double turbidity);
// Ozone, by the cross-sections of [Serdyuchenko2014] at 233 K.
double ozoneDepth(double nm, double dobsonUnits);

// Phase functions in 1/sr. Molecules: with the depolarisation of air [Bucholtz1995].
float rayleighPhase(float cosine);
// Aerosol of a continent [Hess1998]: two Henyey–Greenstein lobes.
float aerosolPhase(float cosine);

// Ways through what the air is made of, over those of a vertical one.
struct AirMasses {
    double molecules = 0, aerosol = 0, ozone = 0;
};

// The air in spherical shells, each of which is alike all through and has the right vertical depth. Distances in km.
class ClearAir {
  public:
    static constexpr int kShells = 32;
    static constexpr double kGroundRadius = 6371, kTop = 100;

    explicit ClearAir(const AirParams&);

    // Lower boundary of a shell, and the upper one of the last.
    double height(int shell) const { return height_[static_cast<std::size_t>(shell)]; }
    double radius(int shell) const { return kGroundRadius + height(shell); }

    // Coefficients in a shell, 1/km. Aerosol scatters much of its light nearly straight on: part of that counts as not
    // scattered at all [Wiscombe1977], except where light is scattered once [Nakajima1988].
    struct Coefficients {
        SkyBands extinction;                 // without that part
        SkyBands rayleigh, aerosol;          // scattering; aerosol with that part
        std::array<SkyBands, 3> scatterings; // scattering without that part times the phase function's Legendre moments
    };
    const Coefficients& at(int shell) const { return shells_[static_cast<std::size_t>(shell)]; }

    // Calls f(shell, t0, t1) for the ways through shells, in their order, of a ray from radius r, km, within or at the
    // lower boundary of `shell` (at its upper one if the ray goes down), against the vertical by the cosine mu. True if
    // it ends at the ground.
    template <typename F> bool walk(double r, int shell, double mu, F f) const {
        const double impact2 = r * r * (1 - mu * mu), middle = -r * mu;
        double t = 0;
        for (; mu < 0; --shell) {
            const double depth2 = square(radius(shell)) - impact2;
            if (depth2 <= 0) break; // it turns in this shell
            const double next = middle - std::sqrt(depth2);
            f(shell, t, next);
            t = next;
            if (shell == 0) return true;
        }
        for (; shell < kShells; ++shell) {
            const double next = middle + safeSqrt(square(radius(shell + 1)) - impact2);
            f(shell, t, next);
            t = next;
        }
        return false;
    }

    // From the ground to the sky, by the cosine against the vertical, > 0. Light goes straight: nothing is refracted.
    AirMasses airMasses(double cosine) const;

    // Share of the light of the sun's disk that arrives, by the cosine of its middle's angle from the vertical: what
    // the ground hides of it and what extinction takes, without the part as above.
    SkyBands sunlight(double r, int shell, double sunCosine) const;

  private:
    std::array<double, kShells + 1> height_;
    std::array<AirMasses, kShells> densities_; // 1/km
    std::array<Coefficients, kShells> shells_;
};

} // namespace abbe
