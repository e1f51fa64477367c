// The phase function of most smoke and clouds in film.
#pragma once

#include "render/phase_function.h"

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

} // namespace abbe
