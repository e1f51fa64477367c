#include "study/curve_statistics.h"

#include "base/check.h"
#include "study/curve_fits.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace abbe {

namespace {

// With eight seeds a rung's own spread is known to a quarter only. It is drawn towards the mean of all rungs, as if
// that were known from so many more seeds.
constexpr double kPriorSeeds = 4;
constexpr double kLeastRelativeError = 1e-6; // rounding
constexpr double kFarthest = 20;             // octaves beyond the ladder that anything is said about
constexpr double kFarthestCompared = 4;      // octaves beyond a ladder that it is compared at
constexpr double kMostHalfNoiseCost = 1000;  // a larger factor cannot be told from one without bound

// Of values that count as often as their weights say, whole numbers: the middle one, or the mean of the two.
double weightedMedian(std::vector<std::pair<double, double>> valuesAndWeights) {
    std::sort(valuesAndWeights.begin(), valuesAndWeights.end());
    double total = 0;
    for (const auto& [value, weight] : valuesAndWeights) total += weight;
    const auto rank = [&](double r) { // from 0
        for (const auto& [value, weight] : valuesAndWeights)
            if ((r -= weight) < 0) return value;
        return valuesAndWeights.back().first;
    };
    return (rank(std::floor((total - 1) / 2)) + rank(std::floor(total / 2))) / 2;
}

// Of each rung.
std::vector<double> weightedMedians(std::span<const SeedRun> runs, std::span<const double> weights,
                                    double RungRun::*figure) {
    std::vector<double> medians;
    for (std::size_t k = 0; k < runs[0].rungs.size(); ++k) {
        std::vector<std::pair<double, double>> values;
        for (std::size_t s = 0; s < runs.size(); ++s) values.emplace_back(runs[s].rungs[k].*figure, weights[s]);
        medians.push_back(weightedMedian(std::move(values)));
    }
    return medians;
}

} // namespace

CurveStatistics::CurveStatistics(std::vector<std::uint32_t> samples, std::vector<SeedRun> runs)
    : samples_(std::move(samples)), runs_(std::move(runs)), bootstrap_(runs_.size()),
      ladder_(samples_.begin(), samples_.end()) {
    ABBE_CHECK(!samples_.empty() && !runs_.empty());
    for (const SeedRun& run : runs_) ABBE_CHECK(run.rungs.size() == samples_.size());
    const auto n = static_cast<double>(runs_.size());
    std::vector<double> variances; // of the mean, relative
    for (std::size_t k = 0; k < rungs(); ++k) {
        const std::vector<double> values = figures(k, &RungRun::relMse);
        const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
        double squares = 0;
        for (const double v : values) squares += (v - mean) * (v - mean);
        variances.push_back(n > 1 && mean != 0 ? squares / (n * (n - 1) * mean * mean) : 0);
    }
    seconds_ = weightedMedians(runs_, std::vector<double>(runs_.size(), 1.0), &RungRun::seconds);
    time_ = TimeModel::fit(ladder_, seconds_);
    const double pooled = std::accumulate(variances.begin(), variances.end(), 0.0) / static_cast<double>(rungs());
    for (const double v : variances) {
        const double drawn = ((n - 1) * v + kPriorSeeds * pooled) / (n - 1 + kPriorSeeds);
        const double least = std::max(drawn, kLeastRelativeError * kLeastRelativeError);
        relativeErrors_.push_back(std::sqrt(least));
        fitWeights_.push_back(1 / least);
    }
}

std::vector<double> CurveStatistics::figures(std::size_t rung, double RungRun::*figure) const {
    std::vector<double> values;
    for (const SeedRun& run : runs_) values.push_back(run.rungs[rung].*figure);
    return values;
}

Estimate CurveStatistics::error(std::size_t rung) const { return meanOnLogScale(figures(rung, &RungRun::relMse)); }

double CurveStatistics::trimmed(std::size_t rung) const {
    return meanWithStudent(figures(rung, &RungRun::trimmed)).value;
}

double CurveStatistics::coreSeconds(std::size_t rung) const {
    return weightedMedians(runs_, std::vector<double>(runs_.size(), 1.0), &RungRun::coreSeconds)[rung];
}

std::uint64_t CurveStatistics::rays(std::size_t rung) const {
    std::uint64_t sum = 0;
    for (const SeedRun& run : runs_) sum += run.rungs[rung].rays;
    return sum / runs_.size();
}

std::optional<double> CurveStatistics::slopeOf(std::span<const double> errors) const {
    const auto law = PowerLaw::fit(ladder_, errors, fitWeights_);
    return law ? std::optional(law->slope) : std::nullopt;
}

Estimate CurveStatistics::slope() const {
    return bootstrap_.estimate([this](Weights w) { return slopeOf(errors(w)); });
}

Estimate CurveStatistics::halfNoiseCost() const {
    const Estimate s = slope();
    const auto cost = [](double v) {
        if (std::isnan(v)) return Estimate::kUnknown;
        const double factor = v < 0 ? std::pow(4, -1 / v) : Estimate::kUnbounded;
        return factor < kMostHalfNoiseCost ? factor : Estimate::kUnbounded;
    };
    const double value = cost(s.value);
    return std::isinf(value) ? Estimate{} : Estimate{value, cost(s.low), cost(s.high)};
}

Estimate CurveStatistics::floor() const {
    std::vector<double> scales;
    const std::vector<double> means = errors(std::vector<double>(runs_.size(), 1.0));
    for (std::size_t k = 0; k < rungs(); ++k)
        scales.push_back(std::max(std::abs(means[k]), 1e-300) * relativeErrors_[k]);
    return bootstrap_.estimate([&](Weights w) -> std::optional<double> {
        const auto law = FlooredLaw::fit(ladder_, errors(w), scales);
        return law ? std::optional(law->floor) : std::nullopt;
    });
}

// Between the first rung from which on all errors are below the target, and the one before.
std::optional<CurveStatistics::Crossing> CurveStatistics::crossing(std::span<const double> errors,
                                                                   double target) const {
    std::size_t first = rungs();
    while (first > 0 && errors[first - 1] <= target) --first;
    if (first > 0 && first < rungs()) {
        const double above = std::log(errors[first - 1]);
        const double below = std::log(std::max(errors[first], 1e-300));
        const double step = (above - std::log(target)) / (above - below);
        return Crossing{static_cast<double>(first - 1) + std::clamp(step, 0.0, 1.0)};
    }
    const std::optional<double> slope = slopeOf(errors);
    if (!slope || !(*slope < 0)) return std::nullopt;
    // In octaves of samples beyond either end; rungs are octaves.
    const std::size_t end = first == 0 ? 0 : rungs() - 1;
    if (!(errors[end] > 0)) return std::nullopt;
    const double octaves = std::log2(target / errors[end]) / *slope;
    if (std::abs(octaves) > kFarthest) return std::nullopt;
    return Crossing{static_cast<double>(end) + octaves};
}

// Beyond the ends rungs go on as octaves of samples.
double CurveStatistics::samplesAt(Crossing c) const {
    const auto last = static_cast<double>(rungs() - 1);
    if (c.position <= 0) return ladder_.front() * std::exp2(c.position);
    if (c.position >= last) return ladder_.back() * std::exp2(c.position - last);
    return between(c, ladder_);
}

// Beyond the ends with the time that a sample takes, so that what is fixed stays so; in proportion to the samples where
// that is unknown.
double CurveStatistics::secondsAt(Crossing c, std::span<const double> seconds) const {
    const auto last = static_cast<double>(rungs() - 1);
    if (c.position > 0 && c.position < last) return between(c, seconds);
    const std::size_t end = c.position <= 0 ? 0 : rungs() - 1;
    const auto model = TimeModel::fit(ladder_, seconds);
    if (!model) return seconds[end] * samplesAt(c) / ladder_[end];
    return std::max(0.0, seconds[end] + model->perSample * (samplesAt(c) - ladder_[end]));
}

double CurveStatistics::between(Crossing c, std::span<const double> ladder) const {
    const auto below = static_cast<std::size_t>(c.position);
    const double step = c.position - static_cast<double>(below);
    return ladder[below] * std::pow(ladder[below + 1] / ladder[below], step);
}

TimeToError CurveStatistics::timeTo(double error, const Estimate& floor) const {
    const double target = error * error;
    TimeToError result;
    const std::vector<double> once(runs_.size(), 1.0);
    const auto found = crossing(errors(once), target);
    result.extrapolated = !found || found->position < 0 || found->position > static_cast<double>(rungs() - 1);
    result.reachable = !result.extrapolated || !floor.bounded() || floor.low <= target;
    if (!found || !result.reachable) return result;
    result.samples = samplesAt(*found);
    result.seconds = bootstrap_.estimate([&](Weights w) -> std::optional<double> {
        const auto where = crossing(errors(w), target);
        return where ? std::optional(secondsAt(*where, weightedMedians(runs_, w, &RungRun::seconds))) : std::nullopt;
    });
    return result;
}

// The time of samples alone is measured, on each core; a fit to times on the wall would have to find it beside pilots
// that took a hundred times as long.
std::vector<double> CurveStatistics::ladderSeconds(std::span<const SeedRun> runs, Weights w, TimeBasis basis) {
    return weightedMedians(runs, w, basis == TimeBasis::whole ? &RungRun::seconds : &RungRun::sampleSeconds);
}

std::vector<double> CurveStatistics::ladderSeconds(TimeBasis basis) const {
    return ladderSeconds(runs_, std::vector<double>(runs_.size(), 1.0), basis);
}

double CurveStatistics::commonSeconds(const CurveStatistics& other, TimeBasis basis) const {
    const auto mine = ladderSeconds(basis), its = other.ladderSeconds(basis);
    const double end = std::min(mine.back(), its.back());
    return std::max({end, mine.front(), its.front()});
}

bool CurveStatistics::aboveNoise(double seconds, TimeBasis basis) const {
    const auto ladder = ladderSeconds(basis);
    std::size_t nearest = 0;
    for (std::size_t k = 1; k < ladder.size(); ++k)
        if (std::abs(std::log(ladder[k] / seconds)) < std::abs(std::log(ladder[nearest] / seconds))) nearest = k;
    const Estimate error = meanWithStudent(figures(nearest, &RungRun::relMse));
    return !error.bounded() || error.low > 0;
}

// Straight between rungs on logarithmic scales; beyond the last one by the fitted slope.
std::optional<double> CurveStatistics::errorAtTime(std::span<const double> errors,
                                                   std::span<const double> ladderSeconds, double seconds) const {
    if (rungs() == 1 || !(ladderSeconds.front() > 0)) return std::nullopt;
    if (seconds >= ladderSeconds.back()) {
        const double more = std::log(seconds / ladderSeconds.back());
        if (more < 1e-12) return errors.back();
        if (more > kFarthestCompared * std::log(2.0)) return std::nullopt;
        const auto slope = slopeOf(errors);
        if (!slope || !(*slope < 0)) return std::nullopt; // rare bright paths: the curve says nothing of what follows
        return errors.back() * std::exp(*slope * more);
    }
    std::size_t above = 1;
    while (above + 1 < rungs() && ladderSeconds[above] < seconds) ++above;
    const double x0 = std::log(ladderSeconds[above - 1]), x1 = std::log(ladderSeconds[above]);
    if (!(errors[above - 1] > 0) || !(errors[above] > 0) || !(x1 > x0)) return std::nullopt;
    const double step = (std::log(seconds) - x0) / (x1 - x0);
    return std::exp(std::lerp(std::log(errors[above - 1]), std::log(errors[above]), step));
}

Estimate CurveStatistics::efficiencyAgainst(const CurveStatistics& other, TimeBasis basis) const {
    std::vector<SeedRun> ours, theirs; // of the seeds that both have
    for (const SeedRun& run : runs_)
        for (const SeedRun& rival : other.runs_)
            if (run.seed == rival.seed) {
                ours.push_back(run);
                theirs.push_back(rival);
            }
    const double seconds = commonSeconds(other, basis);
    if (ours.empty()) return {};
    const auto errorOf = [&](const CurveStatistics& curve, const std::vector<SeedRun>& runs, Weights w) {
        return curve.errorAtTime(weightedMeans(runs, w, &RungRun::relMse), ladderSeconds(runs, w, basis), seconds);
    };
    Estimate ratio = SeedBootstrap(ours.size()).estimate([&](Weights w) -> std::optional<double> {
        const auto mine = errorOf(*this, ours, w), its = errorOf(other, theirs, w);
        if (!mine || !its || !(*mine > 0) || !(*its > 0)) return std::nullopt;
        return *its / *mine;
    });
    // A quotient whose divisor may be 0 has no bound [Fieller1954].
    if (ratio.bounded() && !aboveNoise(seconds, basis)) ratio.high = Estimate::kUnbounded;
    if (ratio.bounded() && !other.aboveNoise(seconds, basis)) ratio.low = 0;
    return ratio;
}

} // namespace abbe
