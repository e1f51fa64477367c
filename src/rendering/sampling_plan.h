// How many samples each pixel takes, decided before the first one.
#pragma once

#include "render/integrator.h"
#include "rendering/plan_pilot.h"

#include <cstdint>
#include <vector>

namespace abbe {

// Pixels take 2^k times the samples that are asked for, k = −2 … 3, so that a render of the same cost has the least
// mean of variance/(Y² + ε), which is what PixelFilm::relativeNoise() is about: n ∝ √(variance/((Y² + ε)·cost)). What
// the pilot says is averaged over neighbours, and believed as far as each half of it foretells the other; on an even
// frame that is not at all. The plan never changes and no sample of the pilot is in the image, so that each pixel is
// the mean of a number of samples that does not depend on them: unbiased [Kirk1991]. It depends on frame, scene and
// seed alone.
class SamplingPlan {
  public:
    static constexpr int kLeast = -2, kMost = 3;

    // All pixels alike.
    SamplingPlan() = default;
    explicit SamplingPlan(const PlanPilot&);

    bool even() const { return factors_.empty(); }
    // k of a pixel of the frame.
    int exponent(int x, int y) const;
    // Mean of 2^k over a rectangle.
    double meanFactor(PixelBounds) const;

    // The samples that stand for `nominal` ones. Ranges that follow each other make ranges that do, from 0 on, and an
    // aligned power of two stays one as long as it has a sample: a net. None is beyond 2^32 − 1.
    static SampleRange scaled(SampleRange nominal, int exponent);

  private:
    float factorAt(float u, float v) const;

    PixelBounds frame_;
    int cellSize_ = 1, columns_ = 0, rows_ = 0;
    std::vector<float> factors_; // of cells, before they are rounded to powers of two; empty: even
};

} // namespace abbe
