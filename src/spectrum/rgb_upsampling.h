// From RGB to spectra [Jakob2019], every colour fitted on its own. See upsampling_table.h for textures.
#pragma once

#include "math/vec.h"
#include "spectrum/color_space.h"
#include "spectrum/curve.h"
#include "spectrum/sigmoid.h"

#include <array>
#include <memory>

namespace abbe {

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
