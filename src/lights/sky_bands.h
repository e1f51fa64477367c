// The wavelengths at which the light of the sky is computed, and values at all of them.
#pragma once

#include "spectrum/spectrum.h"

#include <algorithm>

namespace abbe {

// Sixteen wavelengths, evenly from 360 to 830 nm; arithmetic is per band.
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

} // namespace abbe
