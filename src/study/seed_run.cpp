#include "study/seed_run.h"

#include "base/check.h"

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

} // namespace abbe
