// Where a volume shines, and how brightly.
#pragma once

#include "math/bounds.h"
#include "media/emission_fields.h"
#include "volumes/brick_bounds.h"

#include <vector>

namespace abbe {

// Bricks of the amount's grid in which there may be emission at some time, with `mean` about proportional to what is
// seen of it: never 0 where anything shines. Runs in parallel, the same on any number of threads.
BrickBounds emissionBricks(const EmissionFields&, const GlowTable&);
// The highest temperature there is, K; 0 without temperatures.
double hottest(const EmissionFields&);

// Draws points of bricks with a density in proportion to their `mean`.
class BrickSampler {
  public:
    // Refers to the bricks. Requires some.
    explicit BrickSampler(const BrickBounds&);

    // Index space; u in [0, 1)².
    Vec3d sample(Vec2 u) const noexcept;
    // Of such a point, per voxel; 0 outside of the bricks.
    double density(Vec3 p) const noexcept { return static_cast<double>(bricks_->at(p).mean) * perMean_; }
    // Mean of the points.
    Vec3d centre() const { return centre_; }
    // Holds all points.
    Bounds3d bounds() const;

  private:
    struct Cell {
        Vec3i corner; // voxel
        int size;     // voxels
    };
    const BrickBounds* bricks_;
    std::vector<Cell> cells_;
    std::vector<double> cumulative_; // of the cells' probability, ends at 1
    double perMean_ = 0;
    Vec3d centre_;
};

} // namespace abbe
