#include "film/error_sum.h"

#include "film/pixel_film.h"

#include <algorithm>
#include <cmath>

namespace abbe {

void ErrorSum::closeTile() {
    if (tilePixels_ == 0) return;
    tile_.value = tileSum_ / static_cast<double>(tilePixels_);
    if (pixels_ == 0 || tile_.value > worst_.value) worst_ = tile_;
    pixels_ += tilePixels_;
    sum_ += tileSum_;
    tilePixels_ = 0;
    tileSum_ = 0;
}

void ErrorSum::append(ErrorSum next) {
    closeTile();
    next.closeTile();
    if (next.pixels_ == 0) return;
    if (pixels_ == 0 || next.worst_.value > worst_.value) worst_ = next.worst_;
    pixels_ += next.pixels_;
    sum_ += next.sum_;
    squares_ += next.squares_;
}

// The interval is one for the logarithm: error and estimate vary alike (for normal halves their
// ratio has the distribution F(n, n)), and neither is negative. Where few pixels carry all, Student's factor for their
// number takes the place of the normal one.
ErrorFigure ErrorSum::figure() const {
    ErrorSum all = *this;
    all.closeTile();
    ErrorFigure figure;
    figure.pixels = all.pixels_;
    if (all.pixels_ == 0) return figure;
    figure.worst = all.worst_;
    figure.worst.value = std::sqrt(figure.worst.value);
    if (!(all.sum_ > 0)) return figure;
    figure.value = std::sqrt(all.sum_ / static_cast<double>(all.pixels_));
    const double carried = all.sum_ / all.squares_ * all.sum_; // by so many pixels, were they alike
    const double variance = 4.0 / 3 / carried;                 // of the squared error, relative
    const int degrees = static_cast<int>(std::clamp(std::floor(carried), 1.0, 1e6));
    const double factor = std::exp(studentFactor95(degrees) * std::sqrt(std::log1p(variance)) / 2);
    figure.low = figure.value / factor;
    figure.high = figure.value * factor;
    return figure;
}

} // namespace abbe
