#include "verify/tile_sums.h"

#include <algorithm>

namespace abbe {

namespace {

int ceilDivide(int a, int b) { return (a + b - 1) / b; }

} // namespace

void BlockSums::add(const BlockSums& other) {
    replicates.resize(other.replicates.size());
    for (std::size_t r = 0; r < replicates.size(); ++r)
        for (std::size_t c = 0; c < 3; ++c) replicates[r][c] += other.replicates[r][c];
}

TileSums::TileSums(const PixelFilm& film)
    : width_(film.bounds().width()), height_(film.bounds().height()), columns_(ceilDivide(width_, kTile)),
      rows_(ceilDivide(height_, kTile)), blocks_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {
    const PixelBounds all = film.bounds();
    for (BlockSums& block : blocks_) block.replicates.resize(static_cast<std::size_t>(film.replicates()));
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) {
            auto& block = blocks_[static_cast<std::size_t>(y / kTile * columns_ + x / kTile)];
            for (int r = 0; r < film.replicates(); ++r) {
                const Xyz mean = film.mean(all.x0 + x, all.y0 + y, r, r + 1);
                auto& sum = block.replicates[static_cast<std::size_t>(r)];
                sum[0] += mean.x;
                sum[1] += mean.y;
                sum[2] += mean.z;
            }
        }
}

PixelBounds TileSums::bounds(int column, int row) const {
    return {column * tile_, row * tile_, std::min((column + 1) * tile_, width_), std::min((row + 1) * tile_, height_)};
}

BlockSums TileSums::whole() const {
    TileSums all = *this;
    while (all.blocks_.size() > 1) all = all.coarser();
    return all.blocks_[0];
}

TileSums TileSums::coarser() const {
    TileSums c;
    c.width_ = width_;
    c.height_ = height_;
    c.tile_ = 2 * tile_;
    c.columns_ = ceilDivide(columns_, 2);
    c.rows_ = ceilDivide(rows_, 2);
    c.blocks_.resize(static_cast<std::size_t>(c.columns_) * static_cast<std::size_t>(c.rows_));
    for (int row = 0; row < rows_; ++row)
        for (int column = 0; column < columns_; ++column)
            c.blocks_[static_cast<std::size_t>(row / 2 * c.columns_ + column / 2)].add(at(column, row));
    return c;
}

} // namespace abbe
