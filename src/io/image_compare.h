// Differences between images. All images of a comparison have one size and are interleaved linear RGB.
#pragma once

#include "io/image.h"

#include <optional>

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

} // namespace abbe
