// Which part of a target's cone brings light.
#pragma once

#include "math/distribution_2d.h"

#include <algorithm>
#include <span>
#include <vector>

namespace abbe {

// A piecewise-constant density over the unit square, from which AimCone and the disks of lights far away take their
// directions and places: areas are kept, so that densities carry over.
class AimGrid {
  public:
    static constexpr std::size_t kFinest = 16; // cells of a row

    // Row by row, as many as columns. Requires: > 0 and finite, a square number of them.
    AimGrid(std::span<const double> weights, std::size_t row) : row_(row), cells_(weights, row) {
        for (std::size_t i = 0; i < weights.size(); ++i)
            densities_.push_back(cells_.probability(i % row, i / row) * static_cast<double>(weights.size()));
    }
    // The cell of a grid of n × n that v in [0, 1]² lies in.
    static std::size_t cell(Vec2 v, std::size_t n) {
        const auto at = [n](float x) {
            return std::min(static_cast<std::size_t>(std::max(x, 0.f) * static_cast<float>(n)), n - 1);
        };
        return at(v.y) * n + at(v.x);
    }

    Vec2 sample(Vec2 u) const noexcept {
        const CellSample c = cells_.sample(u);
        const auto n = static_cast<float>(row_);
        return {(static_cast<float>(c.column) + c.offset.x) / n, (static_cast<float>(c.row) + c.offset.y) / n};
    }
    double density(Vec2 v) const noexcept { return densities_[cell(v, row_)]; } // over an even one

  private:
    std::size_t row_;
    Distribution2D cells_;
    std::vector<double> densities_;
};

} // namespace abbe
