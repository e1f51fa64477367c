// Studies without a renderer: curves of error against samples that follow a known law.
#pragma once

#include "study/curve_statistics.h"
#include "support/statistics.h"

#include <cmath>
#include <vector>

namespace abbe::test {

inline const std::vector<std::uint32_t> kLadder{4, 8, 16, 32, 64, 128};

// Errors that fall by a known law. Each rung takes half of its deviation from the rung before, as renders that go on
// do.
struct MadeCurve {
    double scale = 0.1, power = -1, floor = 0, sigma = 0.1, secondsPerSample = 0.01, fixedSeconds = 0;

    double errorAt(double n) const { return floor + scale * std::pow(n, power); }
    CurveStatistics make(std::uint64_t study, std::size_t seeds = 8, std::uint64_t firstSeed = 1) const {
        std::vector<SeedRun> runs;
        for (std::size_t s = 0; s < seeds; ++s) {
            Random random(1000 * study + s + firstSeed);
            SeedRun run{firstSeed + s, {}};
            double deviation = normal(random);
            for (const std::uint32_t n : kLadder) {
                deviation = 0.5 * deviation + std::sqrt(0.75) * normal(random);
                const double falling = scale * std::pow(n, power) * std::exp(sigma * deviation - sigma * sigma / 2);
                const double seconds = fixedSeconds + secondsPerSample * n;
                run.rungs.push_back(
                    {floor + falling, 0.9 * falling, seconds, 2 * seconds, n, 2 * secondsPerSample * n});
            }
            runs.push_back(run);
        }
        return CurveStatistics(kLadder, runs);
    }
    static double normal(Random& random) {
        return std::sqrt(-2 * std::log(random.uniformDouble())) * std::cos(6.283185307179586 * random.uniformDouble());
    }
};

} // namespace abbe::test
