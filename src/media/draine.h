// Dust, fog and small drops, and Rayleigh's air as a limit.
#pragma once

#include "render/phase_function.h"

namespace abbe {

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

} // namespace abbe
