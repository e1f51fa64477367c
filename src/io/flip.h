// FLIP: the difference that an observer sees when two pictures alternate in place, 0 to 1 for each pixel.
#pragma once

#include "io/image.h"

namespace abbe {

// An image of a screen 0.7 m wide with 3840 pixels, seen from 0.7 m [Andersson2020].
inline constexpr double kFlipPixelsPerDegree = 67.0206432765823;

// LDR-FLIP [Andersson2020] of display values. Symmetric in the images.
// Requires equal sizes, finite components, 1 <= pixelsPerDegree <= 1000; linear Rec.709, clipped to 0 … 1.
std::vector<float> ldrFlip(const RgbImage& image, const RgbImage& reference, double pixelsPerDegree);

// HDR-FLIP [Andersson2021]: the largest LDR-FLIP of each pixel over exposures, between the one that shows the brightest
// pixel of the reference just below white and the one that does so for its median.
struct HdrFlip {
    std::vector<float> map;                     // pixel by pixel
    double mean = 0;                            // of the map
    double startExposure = 0, stopExposure = 0; // stops
    int exposures = 0;                          // evenly between them
};
// Any linear RGB: colours are adapted to D65 and clipped to Rec.709 as toDisplayRgb says. Requires equal sizes, at
// least one pixel, finite components, 1 <= pixelsPerDegree <= 1000.
HdrFlip hdrFlip(const RgbImage& image, const RgbImage& reference, double pixelsPerDegree = kFlipPixelsPerDegree);

} // namespace abbe
