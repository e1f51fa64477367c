// Densities over the unit square that are bilinear between the points of a grid, and depend on further numbers between
// whose tabulated values they are linear; and the map from uniform numbers to them. Material files are stated in terms
// of this very map [Dupuy2018, sec. 4.3]: rows by their marginal, then a place in the row.
#pragma once

#include "math/vec.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace abbe {

// Where a number is among values that increase: between `index` and the next, `fraction` of the way. What lies outside
// counts as the nearer end.
struct AxisPlace {
    std::size_t index = 0;
    double fraction = 0; // 0 of a single value
};
AxisPlace placeOnAxis(std::span<const float> values, double x) noexcept;

// Which tables a density is made of, and how much of each; two numbers that it depends on.
struct TableBlend {
    std::array<std::size_t, 4> table{};
    std::array<double, 4> weight{};
    int count = 0;
};
// The first number changes slowest: table (first, second) is first · seconds + second.
TableBlend blendTables(AxisPlace first, AxisPlace second, std::size_t seconds) noexcept;

class BilinearWarp {
  public:
    struct Point {
        Vec2d at;           // in [0, 1]²
        double density = 0; // there, per unit area
    };

    BilinearWarp() = default;
    // Tables of `rows` × `columns` values each, row by row, one after another; each is scaled to be a density. Requires
    // values that are finite and >= 0, in no table all 0; at least 2 × 2.
    BilinearWarp(std::vector<float> values, std::size_t rows, std::size_t columns);

    // Where two uniform numbers in [0, 1] go.
    Point sample(const TableBlend&, Vec2d uniform) const noexcept;
    // The reverse: the numbers that go there, with the density there.
    Point invert(const TableBlend&, Vec2d at) const noexcept;
    double density(const TableBlend&, Vec2d at) const noexcept;

  private:
    double blend(const std::vector<float>& of, std::size_t stride, std::size_t at, const TableBlend&) const noexcept;
    double value(std::size_t row, std::size_t column, const TableBlend& b) const noexcept {
        return blend(values_, rows_ * columns_, row * columns_ + column, b);
    }
    double rowUpTo(std::size_t row, std::size_t column, const TableBlend& b) const noexcept {
        return blend(rowSums_, rows_ * columns_, row * columns_ + column, b);
    }
    double rowTotal(std::size_t row, const TableBlend& b) const noexcept { return rowUpTo(row, columns_ - 1, b); }
    double rowsUpTo(std::size_t row, const TableBlend& b) const noexcept { return blend(sums_, rows_, row, b); }

    std::size_t rows_ = 0, columns_ = 0;
    std::vector<float> values_;  // densities
    std::vector<float> rowSums_; // ∫ of a row up to each column; as many as values
    std::vector<float> sums_;    // ∫ of all rows up to each row; `rows` per table
};

// Bilinear between the points of a grid of `rows` × `columns` values; `at` in [0, 1]².
struct BilinearCell {
    std::size_t row, column;
    double down, across; // within the cell, 0 … 1
    BilinearCell(Vec2d at, std::size_t rows, std::size_t columns) noexcept;
};

} // namespace abbe
