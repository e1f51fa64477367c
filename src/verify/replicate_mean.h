// The mean of one estimator over a block, and how well its replicates know it.
#pragma once

#include "math/vec.h"
#include "verify/tile_sums.h"

#include <algorithm>
#include <cstddef>

namespace abbe {

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
