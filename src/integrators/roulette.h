// Expected-contribution Russian roulette: paths live in proportion to what they can still add to their pixel.
#pragma once

#include "render/film.h"

#include <algorithm>
#include <vector>

namespace abbe {

// The image so far, smoothed, frozen between updates. A path of throughput β survives with
//   P = clamp(|β| L̄ / (t Î), 0.05, 1),
// where Î is the 5×5 mean of earlier passes at its pixel (at least the image's median, so that dark pixels do not keep
// every path alive) and L̄ their mean over the image: the radiance that a continued path finds on average. The floor
// keeps the estimate unbiased and bounds the variance that roulette adds [Vorba2016, sec. 3].
class RouletteReference {
  public:
    static constexpr float kFloor = 0.05f;
    static constexpr float kThreshold = 0.3f; // t: the best of 0.15 to 0.5 in the Cornell box, and flat around it

    explicit RouletteReference(PixelBounds);
    // Takes the film's present means. Not thread-safe against scale().
    void update(const Film&);
    // L̄ / (t Î) of a pixel; before the first update every pixel counts as average.
    float scale(int x, int y) const {
        return scale_.empty() ? 1 / kThreshold
                              : scale_[static_cast<std::size_t>(y - bounds_.y0) * width() + (x - bounds_.x0)];
    }
    static float survival(float meanThroughput, float scale) { return std::clamp(meanThroughput * scale, kFloor, 1.f); }

  private:
    std::size_t width() const { return static_cast<std::size_t>(bounds_.width()); }
    PixelBounds bounds_;
    std::vector<float> scale_;
};

} // namespace abbe
