// FLIP: the difference that an observer sees when two pictures alternate in place, 0 to 1 for each pixel.
#pragma once

#include "io/image.h"

#include <span>
#include <vector>

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

// The linear filters of FLIP: contrast sensitivity of the eye, and detectors of edges and points.

// A plane of numbers, row by row.
struct FlipPlane {
    FlipPlane() = default;
    FlipPlane(int w, int h) : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}

    float* row(int y) { return values.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width); }
    const float* row(int y) const {
        return values.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
    }

    int width = 0, height = 0;
    std::vector<float> values;
};

// Every filter takes a plane with `radius()` rows more above and below than wanted, and gives the wanted rows. Beyond
// the left and the right end the outermost pixels continue. Immutable; shared between threads.
class FlipFilters {
  public:
    // Requires 1 <= pixelsPerDegree <= 1000.
    explicit FlipFilters(double pixelsPerDegree);

    int radius() const { return radius_; }

    // By the contrast sensitivity of each opponent channel; constants stay.
    std::vector<float> achromatic(const FlipPlane&) const;
    std::vector<float> redGreen(const FlipPlane&) const;
    std::vector<float> blueYellow(const FlipPlane&) const;

    // Length of the gradient, and of the second derivatives in x and y, at the scale at which people see features.
    std::vector<float> edges(const FlipPlane&) const;
    std::vector<float> points(const FlipPlane&) const;

  private:
    using Kernel = std::vector<float>; // odd length, centred

    std::vector<float> separable(const FlipPlane&, const Kernel& alongX, const Kernel& alongY) const;
    std::vector<float> features(const FlipPlane&, const Kernel& detector) const;

    Kernel achromatic_, redGreen_, wideYellow_, narrowYellow_; // the last two are weighed
    Kernel featureBlur_, edge_, point_;
    int radius_ = 0;
};

} // namespace abbe
