// Whether two noisy images have the same expectation, judged by their own estimates of their variances.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace abbe {

// An image for the test: values, the estimated variance of each, and what that estimate rests on.
struct NoisyPlane {
    std::span<const float> values, variances;
    int replicates = 2;  // independent estimates behind each variance; at least 2
    double rounding = 0; // relative error of stored values: 2⁻¹¹ for halves
};

// z = (mean A − mean B)/√(SE²) over tiles of 8×8 pixels, turned into normal scores. With equal expectations the scores
// are those of N(0, 1).
struct TileTest {
    std::uint64_t tiles = 0;     // with noise: these have a score
    std::uint64_t noiseless = 0; // where both variances are below rounding
    std::uint64_t skipped = 0;   // with values or variances that are not finite
    std::uint64_t unequal = 0;   // noiseless tiles whose means differ by more than rounding
    double mean = 0, deviation = 0;
    double kolmogorov = 0;            // greatest distance between the distributions of the scores and of N(0, 1)
    double kolmogorovProbability = 1; // of such a distance or a greater one by chance
    double largest = 0;               // the score that is farthest from 0
    double largestProbability = 1;    // of such a one among as many tiles by chance (Bonferroni)
    int largestX = 0, largestY = 0;   // left upper pixel of its tile

    // The smaller probability, 0 if noiseless tiles are unequal.
    double probability() const;
    // One sentence: whether the images agree at a level of 1 %, and if not, in what way.
    std::string verdict() const;
};

// Requires planes of width × height, at least one pixel.
TileTest tileTest(const NoisyPlane& a, const NoisyPlane& b, int width, int height);

} // namespace abbe
