// Piecewise-constant probabilities over a grid: a row by the marginal, then a column of that row.
#pragma once

#include "math/distribution_1d.h"

namespace abbe {

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
