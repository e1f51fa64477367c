#include "caustics/shared/emission_learning.h"

#include "caustics/shared/aim_cone.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

namespace abbe {

namespace {

constexpr std::size_t kMaxPairs = 4096; // of a light and a target that learn their shares one by one
constexpr std::size_t kFinest = AimGrid::kFinest;
constexpr std::size_t kLeastStarts = 8; // of a cell, in the mean
constexpr double kEvenPart = 0.1;       // of a cone
constexpr double kEvenShare = 0.1;      // of all paths

// What was heard of paths from one light to one target.
struct Pair {
    std::vector<double> starts = std::vector<double>(kFinest * kFinest), moments = starts; // by cells
    double started() const { return std::accumulate(starts.begin(), starts.end(), 0.0); }
    double moment() const { return std::accumulate(moments.begin(), moments.end(), 0.0); }
};

// Of cells of the finest grid, in a grid of n × n.
std::vector<double> gathered(const std::vector<double>& cells, std::size_t n) {
    std::vector<double> result(n * n);
    const std::size_t step = kFinest / n;
    for (std::size_t i = 0; i < cells.size(); ++i) result[i / kFinest / step * n + i % kFinest / step] += cells[i];
    return result;
}

// Each cell with its neighbours, which know of it what a few paths do not tell.
std::vector<double> blurred(const std::vector<double>& cells, std::size_t n) {
    std::vector<double> result(cells.size());
    const auto last = static_cast<int>(n) - 1;
    for (int y = 0; y <= last; ++y)
        for (int x = 0; x <= last; ++x)
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx) {
                    const auto from = static_cast<std::size_t>(std::clamp(y + dy, 0, last)) * n +
                                      static_cast<std::size_t>(std::clamp(x + dx, 0, last));
                    result[static_cast<std::size_t>(y) * n + static_cast<std::size_t>(x)] +=
                        cells[from] * (2 - std::abs(dx)) * (2 - std::abs(dy)) / 16;
                }
    return result;
}

// As many cells as paths can tell of; none where they tell nothing.
std::vector<double> partsOf(const Pair& pair) {
    const double started = pair.started();
    std::size_t n = kFinest;
    while (n > 1 && started < static_cast<double>(kLeastStarts * n * n)) n /= 2;
    if (n == 1 || !(pair.moment() > 0)) return {};
    const std::vector<double> starts = blurred(gathered(pair.starts, n), n);
    std::vector<double> parts = blurred(gathered(pair.moments, n), n);
    double sum = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        parts[i] = std::sqrt(parts[i] / std::max(starts[i], 1.0));
        sum += parts[i];
    }
    for (double& p : parts) p = (1 - kEvenPart) * p / sum + kEvenPart / static_cast<double>(parts.size());
    return parts;
}

// √ of the second moment of a path times its share: with parts, that of the mixture of them.
double idealOf(const Pair& pair, const std::vector<double>& parts, double paths) {
    const double started = pair.started();
    double moment = pair.moment();
    if (!parts.empty()) { // of a path, were it drawn by the parts
        const auto n = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(parts.size()))));
        const std::vector<double> moments = gathered(pair.moments, n);
        moment = 0;
        for (std::size_t i = 0; i < parts.size(); ++i)
            moment += moments[i] / (parts[i] * static_cast<double>(parts.size()));
    }
    return std::sqrt(moment * started) / paths;
}

} // namespace

EmissionPlan learnEmission(const EmissionPlan& even, std::size_t lights, std::span<const LightStart> starts,
                           std::span<const LightDeposit> deposits, const NoiseMeasure& measure, bool alone) {
    EmissionPlan plan = even;
    const std::size_t columns = even.targets.size() + 1;
    if (lights * columns > kMaxPairs) return plan;
    std::unordered_map<std::size_t, Pair> heard;
    for (const LightStart& s : starts) ++heard[s.light * columns + s.target].starts[s.part];
    for (const LightDeposit& d : deposits)
        if (alone || NoiseMeasure::isFirefly(measure.brightness(d), d.rho))
            heard[d.start.light * columns + d.start.target].moments[d.start.part] +=
                square(d.luminance) * measure.weight(d.x, d.y) / (alone ? 1 : square(1 + d.rho));
    const auto paths = static_cast<double>(starts.size());
    std::vector<double> ideal(lights * columns), share(ideal.size());
    std::vector<std::vector<double>> parts(lights * (columns - 1));
    for (const auto& [at, pair] : heard) {
        std::vector<double> own = at % columns > 0 ? partsOf(pair) : std::vector<double>();
        ideal[at] = idealOf(pair, own, paths);
        share[at] = pair.started() / paths;
        if (at % columns > 0) parts[at / columns * (columns - 1) + at % columns - 1] = std::move(own);
    }
    // What goes to a target anyway is better left to that target: paths that are not aimed count by what they bring.
    double aimed = 0, unaimed = 0, all = 0;
    for (const auto& [at, pair] : heard) {
        all += pair.moment();
        if (at % columns > 0)
            aimed += ideal[at];
        else
            unaimed += ideal[at] = pair.moment();
    }
    if (!(all > 0)) return plan;
    for (std::size_t i = 0; i < ideal.size(); ++i)
        ideal[i] *= i % columns == 0 ? 1 / all : aimed > 0 ? (1 - unaimed / all) / aimed : 0;
    plan.parts = std::move(parts);
    plan.aim.assign(lights * (columns - 1), 0);
    plan.usefulness.assign(lights, 0);
    double own = 0;
    for (std::size_t l = 0; l < lights; ++l) {
        double before = 0, after = 0;
        for (std::size_t c = 0; c < columns; ++c) {
            const double mixed = kEvenShare * share[l * columns + c] + (1 - kEvenShare) * ideal[l * columns + c];
            before += share[l * columns + c];
            after += mixed;
            if (c == 0)
                own += mixed;
            else
                plan.aim[l * (columns - 1) + c - 1] = mixed;
        }
        plan.usefulness[l] = before > 0 ? after / before : 1;
    }
    plan.uniformShare = static_cast<float>(std::clamp(own, 0.05, 0.6));
    return plan;
}

} // namespace abbe
