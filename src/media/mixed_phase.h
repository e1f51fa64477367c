// Several kinds of particles in one place.
#pragma once

#include "render/phase_function.h"

#include <memory>
#include <vector>

namespace abbe {

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
