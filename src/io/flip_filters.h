// The linear filters of FLIP: contrast sensitivity of the eye, and detectors of edges and points.
#pragma once

#include <span>
#include <vector>

namespace abbe {

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
