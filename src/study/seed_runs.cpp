#include "study/seed_runs.h"

#include "base/check.h"
#include "film/pixel_film.h"
#include "math/hash.h"

#include <algorithm>
#include <numeric>

namespace abbe {

std::vector<double> weightedMeans(std::span<const SeedRun> runs, std::span<const double> weights,
                                  double RungRun::*figure) {
    ABBE_CHECK(!runs.empty() && weights.size() == runs.size());
    std::vector<double> means(runs[0].rungs.size());
    for (std::size_t s = 0; s < runs.size(); ++s)
        for (std::size_t k = 0; k < means.size(); ++k) means[k] += weights[s] * runs[s].rungs[k].*figure;
    const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
    for (double& mean : means) mean /= total;
    return means;
}

namespace {

struct Moments {
    double mean = 0, standardError = Estimate::kUnknown;
};

Moments momentsOf(std::span<const double> values) {
    const auto n = static_cast<double>(values.size());
    Moments m;
    m.mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
    if (values.size() < 2) return m;
    double squares = 0;
    for (const double v : values) squares += (v - m.mean) * (v - m.mean);
    m.standardError = std::sqrt(squares / (n * (n - 1)));
    return m;
}

double studentOf(std::size_t values) { return studentFactor95(static_cast<int>(values) - 1); }

// Linear between order statistics.
double quantile(const std::vector<double>& sorted, double p) {
    const double at = p * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<std::size_t>(at);
    const std::size_t above = std::min(below + 1, sorted.size() - 1);
    return std::lerp(sorted[below], sorted[above], at - static_cast<double>(below));
}

} // namespace

SeedBootstrap::SeedBootstrap(std::size_t seeds) : seeds_(seeds) {
    ABBE_CHECK(seeds >= 1);
    if (seeds < kLeastSeeds) return;
    weights_.resize(seeds * kResamples);
    RandomStream stream(seeds);
    for (int i = 0; i < kResamples; ++i)
        for (std::size_t draw = 0; draw < seeds; ++draw)
            weights_[static_cast<std::size_t>(i) * seeds + (stream.bits() >> 32) * seeds / 0x100000000ull] += 1;
}

Estimate SeedBootstrap::estimate(const Figure& figure) const {
    const std::vector<double> once(seeds_, 1.0);
    Estimate result;
    if (const auto value = figure(once)) result.value = *value;
    if (!result.known() || weights_.empty()) return result;
    std::vector<double> values;
    for (std::size_t i = 0; i < weights_.size(); i += seeds_)
        if (const auto value = figure(std::span(weights_).subspan(i, seeds_))) values.push_back(*value);
    if (values.size() < kResamples - kResamples / 200) return result;
    std::sort(values.begin(), values.end());
    const auto n = static_cast<double>(seeds_);
    const double level = 0.5 * std::erfc(std::sqrt(n / (n - 1)) * studentOf(seeds_) / std::sqrt(2.0));
    result.low = std::min(result.value, quantile(values, level));
    result.high = std::max(result.value, quantile(values, 1 - level));
    return result;
}

Estimate meanWithStudent(std::span<const double> values) {
    if (values.empty()) return {};
    const Moments m = momentsOf(values);
    Estimate e{m.mean};
    if (values.size() < 2) return e;
    const double half = studentOf(values.size()) * m.standardError;
    e.low = m.mean - half;
    e.high = m.mean + half;
    return e;
}

Estimate meanOnLogScale(std::span<const double> values) {
    Estimate e = meanWithStudent(values);
    if (!e.bounded() || !(e.high - e.value < e.value)) return e;
    const double factor = std::exp((e.high - e.value) / e.value);
    e.low = e.value / factor;
    e.high = e.value * factor;
    return e;
}

} // namespace abbe
