// Drops and dust: scattering by spheres of many sizes, at every wavelength.
#pragma once

#include "media/angular_table.h"
#include "media/mie_spheres.h"
#include "render/medium.h"
#include "spectrum/curve.h"

#include <memory>

namespace abbe {

// Lorenz–Mie theory, tabulated at 16 wavelengths from 360 to 830 nm and linear between them. Directions are drawn from
// the mean of the sixteen.
class MiePhase final : public PhaseFunction {
  public:
    static constexpr std::size_t kWavelengths = 16;

    struct Spheres {
        DropSizes sizes;
        const Curve* index = nullptr;        // n, of the spheres
        const Curve* absorption = nullptr;   // k, imaginary part of the index; null for none
        const Curve* surroundings = nullptr; // n around them; null for 1
    };
    // What the table was made from, at each of its wavelengths.
    struct Facts {
        double extinction = 0, scattering = 0, asymmetry = 0; // efficiencies and mean cosine, from the series
        double tableAsymmetry = 0;                            // mean cosine of the table
        double interpolationError = 0;                        // relative, of the table's integral before normalisation
    };

    // Takes a tenth of a second for drops of 10 µm on two cores, a second or two for 100 µm. The curves need not
    // outlive it.
    explicit MiePhase(const Spheres&);

    float value(float cosine) const noexcept override { return mean_->value(cosine); }
    float sampleCosine(float u) const noexcept override { return mean_->sampleCosine(u); }
    bool spectral() const override { return true; }
    Spectrum ratio(float cosine, const Wavelengths&) const noexcept override;

    static double wavelength(std::size_t i); // m, in vacuum
    const std::vector<Facts>& facts() const { return facts_; }
    std::size_t nodes() const { return densities_.size() / kWavelengths; }

  private:
    std::vector<Facts> facts_;
    std::vector<float> densities_; // 1/sr; kWavelengths numbers for each node
    std::unique_ptr<const AngularTable> mean_;
};

} // namespace abbe
