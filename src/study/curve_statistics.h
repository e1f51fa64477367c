// What can be said about the errors of a ladder of samples: means, slope, floor, the time to an error.
#pragma once

#include "study/curve_fits.h"
#include "study/seed_runs.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace abbe {

// Times that curves are compared by: that of the samples alone, summed over threads, or all of it on the wall, with
// what is fixed.
enum class TimeBasis : std::uint8_t { sampling, whole };

// The time, and the samples, at which a curve reaches an error.
struct TimeToError {
    Estimate seconds;
    double samples = Estimate::kUnknown;
    bool extrapolated = false; // beyond the ladder, by the fitted slope
    bool reachable = true;     // false: the floor lies above the error, so that no time is enough
};

// Of one curve. Intervals have 95 %; whole seeds are their unit, because the rungs of a seed are one render.
class CurveStatistics {
  public:
    // Requires at least one run and rung; rising samples; runs with as many rungs as there are samples.
    CurveStatistics(std::vector<std::uint32_t> samples, std::vector<SeedRun> runs);

    std::size_t rungs() const { return samples_.size(); }
    std::span<const SeedRun> runs() const { return runs_; }
    const std::vector<std::uint32_t>& samples() const { return samples_; }

    // Mean relMSE of a rung; the interval by Student's t of the logarithm.
    Estimate error(std::size_t rung) const;
    double trimmed(std::size_t rung) const;
    // Medians over the seeds: other work of the machine only ever adds.
    double seconds(std::size_t rung) const { return seconds_[rung]; }
    double coreSeconds(std::size_t rung) const;
    std::uint64_t rays(std::size_t rung) const; // mean

    // d log relMSE / d log samples, by weighted least squares. Unknown with fewer than two rungs.
    Estimate slope() const;
    // What halving the noise, a quarter of the relMSE, multiplies the samples by: 4^(−1/slope). Infinite from a slope
    // on that is so flat that nobody would wait.
    Estimate halfNoiseCost() const;
    // The relMSE that the curve flattens at: a of a + b N^s. Unknown with fewer than four rungs.
    Estimate floor() const;
    // `error` is a relative RMS, the root of a relMSE. Beyond a floor that is larger for sure it is out of reach.
    // Unknown far beyond the ladder. Requires error > 0.
    TimeToError timeTo(double error, const Estimate& floor) const;
    // Of the medians; unknown where it cannot be told.
    const std::optional<TimeModel>& time() const { return time_; }
    // relMSE of `other` over that of this curve at commonSeconds(): how many times as much an efficiency
    // 1/(relMSE·time) is, where errors fall by 1/time. Seeds that both have are compared in pairs. The high end is
    // infinite where the error of this curve cannot be told from 0. Unknown where one of the two would have to be
    // continued far.
    Estimate efficiencyAgainst(const CurveStatistics& other, TimeBasis) const;
    // Where the shorter of the two ends, or where the later one begins if that is later; the other is then continued.
    double commonSeconds(const CurveStatistics& other, TimeBasis) const;

  private:
    using Weights = std::span<const double>;
    std::vector<double> figures(std::size_t rung, double RungRun::*) const;
    std::vector<double> errors(Weights w) const { return weightedMeans(runs_, w, &RungRun::relMse); }
    std::optional<double> slopeOf(std::span<const double> errors) const;
    // Where the curve crosses `target` on a scale of rungs, logarithmic in between; nothing if it cannot be told.
    struct Crossing {
        double position = 0; // 1.5: half-way from rung 1 to rung 2; negative or beyond the last: extrapolated
    };
    std::optional<Crossing> crossing(std::span<const double> errors, double target) const;
    double samplesAt(Crossing) const;
    double secondsAt(Crossing, std::span<const double> seconds) const;
    double between(Crossing, std::span<const double> ladder) const; // within the ladder
    std::optional<double> errorAtTime(std::span<const double> errors, std::span<const double> ladderSeconds,
                                      double seconds) const;
    // Medians of the rungs.
    static std::vector<double> ladderSeconds(std::span<const SeedRun>, Weights, TimeBasis);
    std::vector<double> ladderSeconds(TimeBasis) const;
    // Of this curve's errors, not negative at 95 %, at the rung that is nearest.
    bool aboveNoise(double seconds, TimeBasis) const;

    std::vector<std::uint32_t> samples_;
    std::vector<SeedRun> runs_;
    SeedBootstrap bootstrap_;
    std::vector<double> ladder_;  // samples_
    std::vector<double> seconds_; // medians
    std::optional<TimeModel> time_;
    std::vector<double> relativeErrors_; // standard errors of the mean relMSE, over the mean
    std::vector<double> fitWeights_;     // 1 over their squares
};

} // namespace abbe
