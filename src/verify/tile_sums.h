// What one estimator came to, in tiles.
#pragma once

#include "film/pixel_film.h"

#include <array>
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

} // namespace abbe
