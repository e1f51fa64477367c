// How different colours look: CIELAB and CIEDE2000, for single colours and over images.
#pragma once

#include "io/image.h"

namespace abbe {

struct Lab {
    double l = 0, a = 0, b = 0;
};
// `white` is the XYZ of L = 100, a = b = 0.
Lab toLab(const Xyz& color, const Xyz& white);

// CIEDE2000 with unit weights. Symmetric; 1 is about what can just be seen side by side.
double deltaE2000(const Lab&, const Lab&);

// Over images. Both are scaled so that the reference has a mean luminance of 0.18, adapted to D65 (Bradford), and light
// brighter than white is shown as bright as white with its chromaticity; black stands for luminances below 0.
struct ColorDifference {
    double mean = 0, percentile95 = 0;         // of the pixels
    double tileMean = 0, tilePercentile95 = 0; // of the means of tiles of 8×8 pixels, where most noise is gone
};
// Requires equal sizes, at least one pixel, finite components.
ColorDifference colorDifference(const RgbImage& image, const RgbImage& reference);

} // namespace abbe
