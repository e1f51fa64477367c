// Adds up estimates of pixels' squared errors to a figure for the image.
#pragma once

#include "film/error_figure.h"

namespace abbe {

// The estimate of a pixel is d², d half the difference of two independent halves of its samples, times a weight. With a
// and b the halves' deviations from their expectation, the squared error is (a + b)²/4 and d² is (a − b)²/4: their
// difference is a b, which has the expectation 0 and the variance 4 σ⁴, σ² that of the pixel, whatever the distribution
// of the samples. A firefly drops out of the difference, because it is in the error as much as in its estimate. Pixels
// are independent, so the variances add up; d⁴/3 expects σ⁴ if the halves are normal, and more with heavier tails.
class ErrorSum {
  public:
    // The pixels that are added from now on belong to this tile.
    void beginTile(PixelBounds tile) {
        closeTile();
        tile_ = {};
        tile_.pixels = tile;
    }
    void add(double squaredError) {
        ++tilePixels_;
        tileSum_ += squaredError;
        squares_ += squaredError * squaredError;
    }
    // Adds what comes after this. Sums depend on the order.
    void append(ErrorSum next);
    ErrorFigure figure() const;

  private:
    void closeTile();

    std::int64_t pixels_ = 0;
    double sum_ = 0, squares_ = 0;
    ErrorFigure::Tile tile_, worst_; // of `worst_` the value is the mean square
    std::int64_t tilePixels_ = 0;
    double tileSum_ = 0;
};

} // namespace abbe
