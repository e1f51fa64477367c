// How different the colours of images look: CIEDE2000 over pixels and over tiles.
#pragma once

#include "io/image.h"

namespace abbe {

// Both images are scaled so that the reference has a mean luminance of 0.18, adapted to D65 as toDisplayRgb says, and
// light brighter than white is shown as bright as white with its chromaticity; black stands for luminances below 0.
struct ColorDifference {
    double mean = 0, percentile95 = 0;         // of the pixels
    double tileMean = 0, tilePercentile95 = 0; // of the means of tiles of 8×8 pixels, where most noise is gone
};
// Requires equal sizes, at least one pixel, finite components.
ColorDifference colorDifference(const RgbImage& image, const RgbImage& reference);

} // namespace abbe
