// Ladders of samples with one seed each: their errors, where they end, so that curves have equal time and not equal
// samples, and figures with intervals of 95 % from few seeds.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace abbe {

// NaN where unknown.
struct Estimate {
    static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

    static constexpr double kUnbounded = std::numeric_limits<double>::infinity();

    double value = kUnknown;
    double low = kUnknown, high = kUnknown; // of 95 %; high kUnbounded: there is no upper bound

    bool known() const { return !std::isnan(value); }
    bool bounded() const { return !std::isnan(low) && !std::isnan(high); }
};

// What a render had come to at one rung of its ladder.
struct RungRun {
    double relMse = 0;      // unbiased: may be negative
    double trimmed = 0;     // without the 0.1 % of pixels that add most
    double seconds = 0;     // of wall clock from the first ray on
    double coreSeconds = 0; // summed over threads
    std::uint64_t rays = 0;
    double sampleSeconds = 0; // of coreSeconds what samples took: without pilots, plans and denoising
};

// One render that went on from rung to rung, so the errors of its rungs are not independent: whatever is said about a
// curve takes whole seeds as its unit.
struct SeedRun {
    std::uint64_t seed = 0;
    std::vector<RungRun> rungs; // as many as the curve has
};

// Means over the seeds, of each rung; a seed counts as often as its weight says. Requires weights that are not all 0.
std::vector<double> weightedMeans(std::span<const SeedRun>, std::span<const double> weights, double RungRun::*figure);

// What a ladder will have taken with one more rung, which has twice the samples: of a part that goes with them and one
// that does not, as that of a denoiser. s; requires two rungs.
inline double secondsWithNextRung(const std::vector<RungRun>& rungs) {
    const double last = rungs.back().seconds, before = rungs[rungs.size() - 2].seconds;
    return last + 2 * std::max(0.0, last - before);
}

// Whether it is taken, beside a main curve of so many seconds. The last rung should end near that time: where a rung
// doubles the time, between 0.8 and 1.6 of it. Two rungs are taken in any case, and whatever nobody waits for.
inline bool worthAnotherRung(const std::vector<RungRun>& rungs, double mainSeconds) {
    constexpr double kMostOfMain = 1.6, kNoticed = 0.25; // s
    return rungs.size() < 2 || secondsWithNextRung(rungs) <= std::max(kNoticed, kMostOfMain * mainSeconds);
}

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
