// Differences between images, and whether they are more than noise.
#pragma once

#include "io/image.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace abbe {

// `relMse` is mean (x − r)²/(r² + 0.01) over all components of images scaled so that the reference has a mean of 0.25.
// A component that is not finite in either image makes every figure but `nonFinite` meaningless (NaN).
struct ImageDifference {
    double mse = 0;
    double relMse = 0;
    double relMseWithoutTail = 0; // without the 0.1 % of pixels that add most to it
    double psnr = 0;              // dB against the largest component of the reference; infinite for equal images
    double maximum = 0;           // largest absolute difference
    double meanRatio = 0;         // mean of the image over mean of the reference
    std::uint64_t nonFinite = 0;  // pixels
};

// Why two images cannot be compared, or nothing.
std::optional<std::string> comparisonFault(const RgbImage& image, const RgbImage& reference);

// Requires !comparisonFault(image, reference).
ImageDifference compare(const RgbImage& image, const RgbImage& reference);

// The noise of the reference cancels: mean (x − a)(x − b)/(r² + 0.01), r = (a + b)/2, for references a and b from
// independent seeds, scaled as above. Can be negative when x is as good as they are. Requires equal sizes.
double unbiasedRelMse(const RgbImage& image, const RgbImage& a, const RgbImage& b);

// How different the colours of images look: CIEDE2000 over pixels and over tiles.
// Both images are scaled so that the reference has a mean luminance of 0.18, adapted to D65 as toDisplayRgb says, and
// light brighter than white is shown as bright as white with its chromaticity; black stands for luminances below 0.
struct ColorDifference {
    double mean = 0, percentile95 = 0;         // of the pixels
    double tileMean = 0, tilePercentile95 = 0; // of the means of tiles of 8×8 pixels, where most noise is gone
};
// Requires equal sizes, at least one pixel, finite components.
ColorDifference colorDifference(const RgbImage& image, const RgbImage& reference);

// Whether two noisy images have the same expectation, judged by their own estimates of their variances.

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
