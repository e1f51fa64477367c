// The density from which the wavelengths of paths are drawn.
#pragma once

#include "spectrum/curve.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace abbe {

// Immutable; copies share their table. By default the sech² density of Wavelengths::sample, which nothing beats where
// spectra are smooth: the eight rotations are a periodic trapezoid rule, and a smooth warp keeps it exact. The light of
// lines and narrow bands falls between them; for it the density follows a table, linear between whole nanometres.
class WavelengthDensity {
  public:
    static constexpr int kNodes = 471; // whole nanometres, 360 … 830
    // What is shown by wavelength, as by the bins of a spectral layer: within [360, 830] nm, first < last.
    struct Shown {
        double first, last;
    };

    WavelengthDensity() = default;
    // p ∝ ‖AP0 matching functions‖ (0.9 P + 0.1 mean P) and nowhere 0, for lights of spectral power P at the nodes, in
    // any unit. The eye would leave bins at both ends next to nothing: where wavelengths are `shown`, half of the
    // density is uniform over them, which takes at most half of the samples from the colours. Requires finite values
    // >= 0, not all 0.
    static WavelengthDensity following(std::span<const double> power, std::optional<Shown> = {});
    // Whichever of the two gives paths less noise under such lights: the table where it at least halves the square of
    // noise().
    // All 0 gives the default.
    static WavelengthDensity bestFor(std::span<const double> power, std::optional<Shown> = {});

    // u in [0, 1): lane j takes the quantile frac(u + j/8). A table needs all of u's bits, for it has nanometres less
    // likely than 2^-20; the smooth density takes the first 24.
    Wavelengths sample(double u) const { return table_ ? tabulated(u) : Wavelengths::sample(first24(u)); }
    double pdf(double nanometres) const; // 1/nm; Requires nanometres within [360, 830]
    bool followsLights() const { return table_ != nullptr; }

    // The standard deviation, relative to the mean, of one path's AP0 colour that the choice of its wavelengths alone
    // causes under lights of that power: root mean square over six reflectances, some of them with steps.
    // Infinite where none of the paths looked at meets the light; 0 if there is none.
    double noise(std::span<const double> power) const;

  private:
    struct Table {
        std::array<double, kNodes> density; // at the nodes, 1/nm
        std::array<double, kNodes> cumulative;
        std::array<float, kNodes> rounded;    // the density, for all lanes at once
        std::array<std::uint16_t, 513> guide; // the last node whose cumulative value is <= i / 512
    };
    static float first24(double u) { return static_cast<float>(static_cast<std::int32_t>(u * 0x1p24)) * 0x1p-24f; }
    static std::shared_ptr<const Table> tableOf(std::span<const double> density);
    Wavelengths tabulated(double u) const;
    std::shared_ptr<const Table> table_;
};

} // namespace abbe
