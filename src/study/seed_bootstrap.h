// Intervals of 95 % from few seeds.
#pragma once

#include "study/estimate.h"

#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace abbe {

// Draws the seeds again, with repetition, and looks how far a figure moves. With few seeds plain percentiles are too
// narrow: they lack the factor √(n/(n − 1)) and know no t distribution. The expanded percentiles of [Hesterberg2015,
// sec. 5.3] make up for both: the level p of a percentile is Φ(−√(n/(n − 1)) t) with Student's t of n − 1 degrees.
class SeedBootstrap {
  public:
    static constexpr int kResamples = 2000;
    static constexpr int kLeastSeeds = 5; // fewer have too few different resamples

    // The same resamples for the same number of seeds. Requires seeds >= 1.
    explicit SeedBootstrap(std::size_t seeds);

    // A figure of the seeds, each counted as often as its weight says; nothing if it has no value for them.
    using Figure = std::function<std::optional<double>(std::span<const double> weights)>;
    // The interval is unknown with too few seeds, or if the figure has no value for more than one resample of 200.
    Estimate estimate(const Figure&) const;

  private:
    std::size_t seeds_;
    std::vector<double> weights_; // of all resamples, one after the other
};

// The mean of values whose logarithm is nearer to normal than they are: a 95 % interval by Student's t on the scale of
// logarithms (delta method), which is never negative and reaches further up than down; on the plain scale if the
// interval would hold 0 there.
Estimate meanOnLogScale(std::span<const double> values);
// On the plain scale.
Estimate meanWithStudent(std::span<const double> values);

} // namespace abbe
