// Weights of NL-means: how much a neighbour's surroundings look like a pixel's, given their noise.
#pragma once

#include "denoise/plane.h"
#include "denoise/tiles.h"

#include <span>
#include <vector>

namespace abbe {

// A noisy picture of one or several planes with the variance of each pixel, borders extended. The planes outlive it.
struct Guide {
    std::vector<const Plane*> values, variances;
    float epsilon = 0; // squared difference that counts as none, > 0
};

// The weights of one tile against a window of neighbours, at the bandwidth k = 2 of [Bitterli2016, eq. 5]; the weights
// of another k are these to the power of 4/k².
class PatchWeights {
  public:
    static constexpr int kPatchRadius = 1;

    // Requires windowRadius <= 9.
    explicit PatchWeights(int windowRadius);

    int windowRadius() const { return radius_; }
    void compute(const Guide& guide, const Tile& tile);
    // The weights of the tile's row y (from 0) for the neighbours (dx, dy); 0 where one of the two pixels lies outside
    // the picture.
    const float* row(int dx, int dy, int y) const { return weights_.data() + offset(dx, dy, y); }

  private:
    std::size_t offset(int dx, int dy, int y) const {
        const int side = 2 * radius_ + 1, neighbour = (dy + radius_) * side + dx + radius_;
        return static_cast<std::size_t>((neighbour * Tile::kSize + y) * Tile::kSize);
    }
    void measure(const Guide& guide, const Tile& tile, int dx, int dy);
    void average(const Tile& tile, int dx, int dy);
    void clip(const Guide& guide, const Tile& tile, int dx, int dy);

    int radius_;
    std::vector<float> weights_;
    std::vector<float> distances_; // of single pixels: the tile and a patch's radius around it
};

} // namespace abbe
