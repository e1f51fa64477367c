// The density from which the wavelengths of paths are drawn.
#pragma once

#include "spectrum/curve.h"

#include <array>
#include <memory>
#include <span>
#include <vector>

namespace abbe {

// Immutable; copies share their table. By default the sech² density of Wavelengths::sample, which nothing beats where
// spectra are smooth: the eight rotations are a periodic trapezoid rule, and a smooth warp keeps it exact. The light of
// lines and narrow bands falls between them; for it the density follows a table, linear between whole nanometres.
class WavelengthDensity {
  public:
    static constexpr int kNodes = 471; // whole nanometres, 360 … 830

    WavelengthDensity() = default;
    // p ∝ ‖AP0 matching functions‖ (0.9 P + 0.1 mean P) and nowhere 0, for lights of spectral power P at the nodes, in
    // any unit. Requires finite values >= 0, not all 0.
    static WavelengthDensity following(std::span<const double> power);
    // Whichever of the two gives paths less noise under such lights: the table where it at least halves the square of
    // noise().
    // All 0 gives the default.
    static WavelengthDensity bestFor(std::span<const double> power);

    // u in [0, 1): lane j takes the quantile frac(u + j/8).
    Wavelengths sample(float u) const { return table_ ? tabulated(u) : Wavelengths::sample(u); }
    double pdf(double nanometres) const; // 1/nm; Requires nanometres within [360, 830]
    bool followsLights() const { return table_ != nullptr; }

    // The standard deviation, relative to the mean, of one path's AP0 colour that the choice of its wavelengths alone
    // causes under lights of that power: root mean square over six reflectances, some of them with steps.
    // Infinite where none of the paths looked at meets the light; 0 if there is none.
    double noise(std::span<const double> power) const;

  private:
    struct Table {
        std::array<float, kNodes> density; // at the nodes, 1/nm
        std::array<float, kNodes> cumulative;
        std::array<std::uint16_t, 513> guide; // the last node whose cumulative value is <= i / 512
    };
    Wavelengths tabulated(float u) const;
    std::shared_ptr<const Table> table_;
};

} // namespace abbe
