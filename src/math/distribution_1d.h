// Piecewise-constant densities over [0, 1): n bins of equal width and arbitrary weight.
#pragma once

#include "math/vec.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace abbe {

// A bin drawn in proportion to its weight.
struct BinSample {
    std::uint32_t index = 0;
    float offset = 0;       // where in the bin's share of the random number, [0, 1): can be used again
    double probability = 0; // > 0
};

// Writes weights.size() + 1 cumulative probabilities in double, from 0 to exactly 1, and returns the sum of the
// weights. A sum of 0 gives every bin the same probability. Requires: weights finite, >= 0, not none.
double buildCumulative(std::span<const double> weights, std::span<double> cumulative);
// u in [0, 1). Never a bin of probability 0: it is the bin whose half-open interval of cumulative probability holds u.
BinSample sampleCumulative(std::span<const double> cumulative, float u) noexcept;

class Distribution1D {
  public:
    // Requires: as for buildCumulative.
    explicit Distribution1D(std::span<const double> weights);

    std::size_t size() const { return cumulative_.size() - 1; }
    double total() const { return total_; } // of the weights; 0 means that nothing should be sampled
    BinSample sample(float u) const noexcept { return sampleCumulative(cumulative_, u); }
    // The bin alone, by a number with the digits to tell bins apart that are less likely than those of a float.
    std::uint32_t pick(double u) const noexcept;
    double probability(std::size_t bin) const noexcept { return cumulative_[bin + 1] - cumulative_[bin]; }

    // The same as a density over [0, 1).
    struct Point {
        float x = 0;
        float pdf = 0;
    };
    Point samplePoint(float u) const noexcept;
    float pdf(float x) const noexcept;
    float inverse(float x) const noexcept; // the u of samplePoint

  private:
    std::size_t bin(float x) const noexcept;
    std::vector<double> cumulative_;
    double total_;
};

} // namespace abbe
