// What turns spectra into the three numbers of a pixel: the CIE observer, or a camera's sensitivities.
#pragma once

#include "spectrum/curve.h"
#include "spectrum/data/cameras.h"
#include "spectrum/xyz.h"

#include <array>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

namespace abbe {

// The CIE 1931 2° standard observer: from spectra to XYZ. Scale: unit radiance per nanometre at every wavelength has
// Y = 1. Multiply by kYIntegral (nm) and 683 lm/W for photometric quantities.

// ∫ ȳ dλ over [360, 830] of the piecewise-linear 1 nm table, in nm.
inline constexpr double kYIntegral = 106.856914916767;
// Luminous efficacy of monochromatic radiation of 540 THz, lm/W [BIPM2019].
inline constexpr double kLuminousEfficacy = 683;
// Luminance of Y = 1, cd/m²; likewise illuminance, lx.
inline constexpr double kUnitLuminance = kLuminousEfficacy * kYIntegral;

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

// One path's estimate of ∫ L (x̄, ȳ, z̄) dλ / ∫ ȳ dλ, unbiased over Wavelengths::sample(u) for uniform u. Other tables of
// 470 cells than the observer's: sensor.h.
inline Xyz toXyz(const Spectrum& radiance, const Wavelengths& w,
                 const detail::ObserverCell* table = detail::kObserver.data()) {
    constexpr float scale = static_cast<float>(1 / (kLanes * kYIntegral));
    const Float8 weight = radiance.v / w.pdf.v * scale;
    const Float8 end = weight * w.fraction.v, start = weight - end;
    // Lane j's weights of both ends of its cell, four times each, are one in-half permutation of these.
    const __m256 low = _mm256_permute2f128_ps(start, end, 0x20), high = _mm256_permute2f128_ps(start, end, 0x31);
    const auto cell = [&](int j) { return _mm256_load_ps(table[w.cell[j]].value); };
    const __m256 even =
        _mm256_fmadd_ps(cell(0), _mm256_permute_ps(low, 0x00), _mm256_mul_ps(cell(2), _mm256_permute_ps(low, 0xaa)));
    const __m256 odd =
        _mm256_fmadd_ps(cell(1), _mm256_permute_ps(low, 0x55), _mm256_mul_ps(cell(3), _mm256_permute_ps(low, 0xff)));
    const __m256 evenHigh =
        _mm256_fmadd_ps(cell(4), _mm256_permute_ps(high, 0x00), _mm256_mul_ps(cell(6), _mm256_permute_ps(high, 0xaa)));
    const __m256 oddHigh =
        _mm256_fmadd_ps(cell(5), _mm256_permute_ps(high, 0x55), _mm256_mul_ps(cell(7), _mm256_permute_ps(high, 0xff)));
    const Float8 total = (even + odd) + (evenHigh + oddHigh);
    const __m128 xyz = _mm_add_ps(_mm256_castps256_ps128(total), _mm256_extractf128_ps(total, 1));
    const __m256d wide = _mm256_cvtps_pd(xyz);
    return {wide[0], wide[1], wide[2]};
}

// ∫ f (x̄, ȳ, z̄) dλ / ∫ ȳ dλ, exact for piecewise-linear f with nodes at whole nanometres.
Xyz integrate(const Curve& f);
// The same for the product f g of two such curves: a reflectance under an illuminant.
Xyz integrate(const Curve& f, const Curve& g);

// Immutable; shared between threads. Costs the same per sample whatever it is: three sums over one table.
class Sensor {
  public:
    // The CIE 1931 2° observer: bit for bit toXyz().
    Sensor() = default;
    // A camera with a 3×3 matrix from its signals to XYZ, which gives `light` itself exactly and the 24 patches of the
    // ColorChecker under it with the least squared error [Langlands2020; Pharr2023, sec. 5.4.2]. What a camera sees
    // alike stays alike: colours differ from the observer's where its sensitivities do.
    // Requires that the light has power where the camera is sensitive.
    Sensor(const CameraSensitivities&, const Curve& light);

    // One path's estimate, as toXyz().
    Xyz operator()(const Spectrum& radiance, const Wavelengths& w) const { return toXyz(radiance, w, cells_); }
    // What it tends to: exact for piecewise-linear curves with nodes at whole nanometres.
    Xyz integrate(const Curve&) const;
    bool isObserver() const { return !table_; }

  private:
    using Table = std::array<detail::ObserverCell, 470>;
    std::unique_ptr<const Table> table_; // null: the observer's
    const detail::ObserverCell* cells_ = detail::kObserver.data();
};

// "nikon-d850", …; null for other names.
const CameraSensitivities* findSensitivities(std::string_view name);
std::vector<std::string_view> sensorNames();

} // namespace abbe
