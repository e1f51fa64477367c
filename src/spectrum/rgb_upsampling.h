// From RGB to spectra [Jakob2019], every colour fitted on its own. See upsampling_table.h for textures.
#pragma once

#include "math/vec.h"
#include "spectrum/color_space.h"
#include "spectrum/curve.h"
#include "spectrum/spectrum.h"

#include <array>
#include <cmath>
#include <memory>

namespace abbe {

// The reflectance model: a sigmoid of a quadratic polynomial of wavelength. Smooth, and within (0, 1).
// R(λ) = 1/2 + x / (2 √(1 + x²)), x = (c0 t + c1) t + c2 with t = (λ - 595 nm) / 235 nm: in plain nanometres the terms
// of x cancel in float. c2 = ±∞ with c0 = c1 = 0 is exactly white or black.
struct SigmoidCoefficients {
    float c0 = 0, c1 = 0, c2 = 0;

    Spectrum at(const Wavelengths& w) const {
        const Spectrum t((w.nm.v - 595.f) * (1 / 235.f));
        const Spectrum x = fma(fma(Spectrum(c0), t, Spectrum(c1)), t, Spectrum(c2));
        // 1/2 - |x| / (2s) without its cancellation, s = √(1 + x²).
        const Spectrum a = abs(x);
        const Spectrum s = sqrt(fma(a, a, Spectrum(1.f)));
        const Spectrum tail(0.5f / (s.v * (s.v + a.v)));
        return select(x.v < 0.f, tail, Spectrum(1.f) - tail);
    }
};

// The same in double, for fitting and tables.
struct SigmoidCurve {
    double c0 = 0, c1 = 0, c2 = 0;

    double at(double nanometres) const {
        const double t = (nanometres - 595) / 235;
        const double x = (c0 * t + c1) * t + c2, a = std::abs(x), s = std::sqrt(a * a + 1);
        const double tail = 0.5 / (s * (s + a));
        return x < 0 ? tail : 1 - tail;
    }
    // The flat curve of a value in [0, 1].
    static SigmoidCurve flat(double value);
    SigmoidCoefficients coefficients() const {
        return {static_cast<float>(c0), static_cast<float>(c1), static_cast<float>(c2)};
    }
};

struct ReflectanceFit {
    SigmoidCurve curve;
    Vec3d achieved;    // the RGB of the curve under the space's white
    double deltaE = 0; // CIEDE2000 between achieved and wanted; above 0.01 the colour is no reflectance of this model
};

// Finds the reflectance whose colour under the white of an RGB space is the one wanted. Colours outside the solid of
// object colours get the nearest curve (least CIE 1976 difference) and its residual. White is exactly 1, black exactly
// 0 and greys are exactly flat: each channel is measured relative to the tabulated illuminant, whose white agrees with
// that of the space to about 1e-4. Everywhere here: requires finite RGB.
class ReflectanceFitter {
  public:
    // stepNm is the spacing of the quadrature, 1 or 5.
    explicit ReflectanceFitter(const RgbSpace&, int stepNm = 1);

    ReflectanceFit fit(const Vec3d& rgb) const;
    // The same from a curve that is probably near. Faster.
    ReflectanceFit fit(const Vec3d& rgb, const SigmoidCurve& start) const;
    // The RGB of a curve.
    Vec3d rgb(const SigmoidCurve&) const;

  private:
    static constexpr std::size_t kMaxNodes = 472; // a multiple of four

    struct Moments { // of a curve
        Vec3d rgb;
        double gradient[3][3]; // d rgb[i] / d c[k]
    };
    Moments moments(const SigmoidCurve&) const;
    ReflectanceFit descend(const Vec3d& rgb, SigmoidCurve start) const;

    alignas(32) std::array<double, kMaxNodes> t_{};         // normalised wavelength of each node
    alignas(32) std::array<double, kMaxNodes> weight_[3]{}; // rgb[i] = Σ weight_[i] R
    std::size_t nodes_ = 0;
    Matrix3 toXyz_;
    Xyz white_;
};

ReflectanceFit fitReflectance(const Vec3d& rgb, const RgbSpace&);

// A curve for an RGB value and how well it does.
struct UpsampledCurve {
    std::unique_ptr<Curve> curve;
    double deltaE = 0; // as in ReflectanceFit, at half brightness for emission and unbounded values
};

// For albedos. Greys give a ConstantCurve.
UpsampledCurve reflectanceFromRgb(const Vec3d& rgb, const RgbSpace&);
// For quantities without upper bound (coefficients, densities): 2 max(rgb) times a reflectance of at most 1/2 or so.
UpsampledCurve unboundedFromRgb(const Vec3d& rgb, const RgbSpace&);
// For light: the same times the illuminant of the space with Y = 1, so that (1, 1, 1) is that illuminant.
UpsampledCurve emissionFromRgb(const Vec3d& rgb, const RgbSpace&);

} // namespace abbe
