// Whether two estimators came to the same picture.
#pragma once

#include "verify/tile_sums.h"

#include <vector>

namespace abbe {

// One block of the picture in the channel in which the two are farthest apart.
struct BlockTest {
    PixelBounds bounds;
    int channel = 1;       // X, Y or Z
    double difference = 0; // of the second estimator from the first, over the first's mean
    double error = 0;      // standard error of that
    double score = 0;      // as a normal one
    double freedom = 1;    // degrees of it
    bool judged = true;    // false: one replicate makes more than half of the variance, so that nobody knows it
    bool exact = false;    // no noise, and no difference beyond rounding: not counted
};

// Welch's test of the means of replicates [Welch1947] on the whole picture and on blocks of 8×8 pixels, of 16×16 and so
// on up to half of it. Half of the level goes to the whole, half to the blocks, and every block and channel counts as a
// test (Bonferroni).
struct Agreement {
    BlockTest whole;
    std::vector<BlockTest> blocks; // judged ones of all sizes, the farthest apart first
    int tiles = 0;                 // of 8×8
    int unjudged = 0;              // of these, too noisy to be judged
    double probability = 1;        // of such a difference or a greater one by chance
    double level = 0.001;

    bool agrees() const { return probability > level; }
    // Relative difference of the whole picture that would have been seen in 99 of 100 runs.
    double detectable() const;
    // Blocks that by themselves say that the two differ; none that lies within one before it.
    std::vector<BlockTest> worstBlocks(std::size_t most) const;
};

// Requires sums of the same picture with at least three replicates each.
Agreement compare(const TileSums& a, const TileSums& b, double level);

} // namespace abbe
