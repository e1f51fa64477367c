// A phase function measured or computed elsewhere.
#pragma once

#include "media/angular_table.h"
#include "render/phase_function.h"

namespace abbe {

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

} // namespace abbe
