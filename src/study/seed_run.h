// The errors of one ladder of samples with one seed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace abbe {

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

} // namespace abbe
