// Phase functions: of most smoke and clouds in film; of dust, fog and small drops, with Rayleigh's air as a limit; one
// that was measured or computed elsewhere; and that of several kinds of particles in one place.
#pragma once

#include "media/angular_table.h"
#include "render/medium.h"

#include <memory>
#include <vector>

namespace abbe {

// [Henyey1941]; g in (-1, 1) is the mean cosine: 0 scatters evenly, positive values forward.
class HenyeyGreenstein final : public PhaseFunction {
  public:
    explicit HenyeyGreenstein(double g) : g_(static_cast<float>(g)) {}
    float value(float cosine) const noexcept override;
    float sampleCosine(float u) const noexcept override;

  private:
    float g_;
};

// (1 + α cos²θ) times Henyey–Greenstein, normalised [Draine2003, eq. 5]. α = 0 is Henyey–Greenstein; g = 0 and α = 1 is
// Rayleigh.
class Draine final : public PhaseFunction {
  public:
    // g in (-1, 1), α >= 0.
    Draine(double g, double alpha);
    float value(float cosine) const noexcept override;
    float sampleCosine(float u) const noexcept override;

  private:
    double cdf(double cosine) const;
    double primitive(double cosine) const; // of the density over cos, for |g| not small

    double g_, alpha_;
    double norm_;      // of the density over the cosine
    double lower_ = 0; // primitive(-1)
};

// Linear in the cosine between the angles given.
class TabulatedPhase final : public PhaseFunction {
  public:
    // Requires: angles in rad, increasing from 0 to π, with a value each: finite, >= 0, not all 0.
    TabulatedPhase(std::span<const double> angles, std::span<const double> values)
        : TabulatedPhase(AngularGrid(angles), values) {}
    float value(float cosine) const noexcept override { return table_.value(cosine); }
    float sampleCosine(float u) const noexcept override { return table_.sampleCosine(u); }

  private:
    TabulatedPhase(const AngularGrid& grid, std::span<const double> values) : table_(grid, grid.atNodes(values)) {}
    AngularTable table_;
};

class MixedPhase final : public PhaseFunction {
  public:
    struct Part {
        std::shared_ptr<const PhaseFunction> phase;
        double weight = 1; // its share of what is scattered, relative to the others'
    };
    // Requires: weights finite, >= 0, not all 0.
    explicit MixedPhase(std::vector<Part>);

    float value(float cosine) const noexcept override;
    float sampleCosine(float u) const noexcept override;
    bool spectral() const override { return spectral_; }
    Spectrum ratio(float cosine, const Wavelengths&) const noexcept override;

  private:
    struct Lobe {
        std::shared_ptr<const PhaseFunction> phase;
        float weight;
        double below; // sum of the weights before it
    };
    std::vector<Lobe> lobes_; // those of a weight above 0
    bool spectral_ = false;
};

} // namespace abbe
