// The CIE 1931 2° standard observer: from spectra to XYZ. Scale: unit radiance per nanometre at every wavelength has
// Y = 1. Multiply by kYIntegral (nm) and 683 lm/W for photometric quantities.
#pragma once

#include "spectrum/curve.h"
#include "spectrum/xyz.h"

#include <array>

namespace abbe {

// ∫ ȳ dλ over [360, 830] of the piecewise-linear 1 nm table, in nm.
inline constexpr double kYIntegral = 106.856914916767;
// Luminous efficacy of monochromatic radiation of 540 THz, lm/W [BIPM2019].
inline constexpr double kLuminousEfficacy = 683;

namespace detail {
// A cell of 1 nm: x̄ ȳ z̄ 0 at its start, then at its end, so that one load fetches all that a lane needs.
struct alignas(32) ObserverCell {
    float value[8];
};
extern const std::array<ObserverCell, 470> kObserver;
} // namespace detail

// The matching functions at each lane.
Spectrum xbar(const Wavelengths&);
Spectrum ybar(const Wavelengths&);
Spectrum zbar(const Wavelengths&);

// One path's estimate of ∫ L (x̄, ȳ, z̄) dλ / ∫ ȳ dλ, unbiased over Wavelengths::sample(u) for uniform u.
inline Xyz toXyz(const Spectrum& radiance, const Wavelengths& w) {
    constexpr float scale = static_cast<float>(1 / (kLanes * kYIntegral));
    const Float8 weight = radiance.v / w.pdf.v * scale;
    const Float8 end = weight * w.fraction.v;
    alignas(32) float atStart[8], atEnd[8];
    alignas(32) std::int32_t cell[8];
    _mm256_store_ps(atStart, weight - end);
    _mm256_store_ps(atEnd, end);
    _mm256_store_si256(reinterpret_cast<__m256i*>(cell), reinterpret_cast<__m256i>(w.cell));
    const auto lane = [&](int j) {
        const __m256 pair = _mm256_blend_ps(_mm256_broadcast_ss(atStart + j), _mm256_broadcast_ss(atEnd + j), 0xf0);
        return _mm256_mul_ps(_mm256_load_ps(detail::kObserver[static_cast<std::size_t>(cell[j])].value), pair);
    };
    const Float8 total = ((lane(0) + lane(1)) + (lane(2) + lane(3))) + ((lane(4) + lane(5)) + (lane(6) + lane(7)));
    const __m128 xyz = _mm_add_ps(_mm256_castps256_ps128(total), _mm256_extractf128_ps(total, 1));
    const __m256d wide = _mm256_cvtps_pd(xyz);
    return {wide[0], wide[1], wide[2]};
}

// ∫ f (x̄, ȳ, z̄) dλ / ∫ ȳ dλ, exact for piecewise-linear f with nodes at whole nanometres.
Xyz integrate(const Curve& f);
// The same for the product f g of two such curves: a reflectance under an illuminant.
Xyz integrate(const Curve& f, const Curve& g);

} // namespace abbe
