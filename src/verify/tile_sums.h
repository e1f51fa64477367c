// What one estimator came to, in tiles: its mean over a block, and how well its replicates know it.
#pragma once

#include "film/pixel_film.h"
#include "math/vec.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace abbe {

// Sums over the pixels of a block, one for each replicate and channel (X, Y, Z).
struct BlockSums {
    std::vector<std::array<double, 3>> replicates;

    void add(const BlockSums&);
};

// Blocks of a picture, row by row; those at the right and lower edge may be smaller.
class TileSums {
  public:
    static constexpr int kTile = 8; // pixels

    explicit TileSums(const PixelFilm&);

    int columns() const { return columns_; }
    int rows() const { return rows_; }
    const BlockSums& at(int column, int row) const {
        return blocks_[static_cast<std::size_t>(row * columns_ + column)];
    }
    // Where that block is.
    PixelBounds bounds(int column, int row) const;
    // Blocks of twice the size, put together from these.
    TileSums coarser() const;
    // Of the whole picture.
    BlockSums whole() const;

  private:
    TileSums() = default;

    int width_ = 0, height_ = 0, tile_ = kTile, columns_ = 0, rows_ = 0;
    std::vector<BlockSums> blocks_;
};

// Requires at least two replicates.
struct ReplicateMean {
    double value = 0, variance = 0; // of the sum over the block; `variance` is that of the mean
    double freedom = 1;             // degrees of it
    double largestPart = 0;         // of a single replicate, in the variance

    ReplicateMean(const BlockSums& sums, std::size_t channel) {
        const auto n = static_cast<double>(sums.replicates.size());
        for (const auto& r : sums.replicates) value += r[channel] / n;
        double squares = 0, largest = 0;
        for (const auto& r : sums.replicates) {
            const double d = square(r[channel] - value);
            squares += d;
            largest = std::max(largest, d);
        }
        freedom = n - 1;
        variance = squares / (n * freedom);
        if (squares > 0) largestPart = largest / squares;
    }
};

} // namespace abbe
