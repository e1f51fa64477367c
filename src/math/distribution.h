// Piecewise-constant densities over [0, 1), n bins of equal width and arbitrary weight, and over grids of them.
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

// Piecewise-constant probabilities over a grid: a row by the marginal, then a column of that row.

struct CellSample {
    std::uint32_t column = 0, row = 0;
    Vec2 offset;            // within the cell, [0, 1)²
    double probability = 0; // of the cell, > 0
};

class Distribution2D {
  public:
    // Row by row, `columns` each. Requires: finite, >= 0, a whole number of rows, not none.
    Distribution2D(std::span<const double> weights, std::size_t columns);

    std::size_t columns() const { return columns_; }
    std::size_t rows() const { return marginal_.size(); }
    double total() const { return marginal_.total(); } // of the weights; 0 means that nothing should be sampled
    CellSample sample(Vec2 u) const noexcept;          // u.x chooses the column, u.y the row
    double probability(std::size_t column, std::size_t row) const noexcept;

  private:
    std::span<const double> cumulative(std::size_t row) const noexcept {
        return {conditional_.data() + row * (columns_ + 1), columns_ + 1};
    }
    std::size_t columns_;
    std::vector<double> conditional_; // rows of columns + 1
    Distribution1D marginal_;
};

} // namespace abbe
