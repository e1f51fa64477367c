// Expected-contribution Russian roulette: paths live in proportion to what they can still add to their pixel.
#pragma once

#include "transport/pilot_film.h"

#include <algorithm>
#include <vector>

namespace abbe {

// What pixels are expected to show, from the pilot. A path of throughput β survives with
//   P = clamp(|β| L̄ / (t Î), 0.05, 1),
// where Î is the pilot around the pixel, 5×5 cells and linear between them (at least the frame's median, so that dark
// pixels do not keep every path alive) and L̄ its mean over the frame: the radiance that a continued path finds on
// average. The floor keeps the estimate unbiased and bounds the variance that roulette adds [Vorba2016, sec. 3].
class RouletteReference {
  public:
    static constexpr float kFloor = 0.05f;
    static constexpr float kThreshold = 0.3f; // t: the best of 0.15 to 0.5 in the Cornell box, and flat around it

    // Every pixel counts as average.
    RouletteReference() = default;
    explicit RouletteReference(const PilotFilm&);
    // The same scale for all pixels, whatever they show; finite and positive.
    static RouletteReference constant(float scale) {
        RouletteReference result;
        result.scaleWithout_ = scale;
        return result;
    }
    // L̄ / (t Î) of a pixel of the frame.
    float scale(int x, int y) const;
    // L̄, W·m⁻²·sr⁻¹ weighed with ȳ as the film's Y; 0 if nothing was seen, or looked at.
    float average() const { return average_; }
    static float survival(float meanThroughput, float scale) { return std::clamp(meanThroughput * scale, kFloor, 1.f); }

  private:
    PixelBounds frame_;
    int cellSize_ = 1, columns_ = 0, rows_ = 0;
    std::vector<float> expected_; // t Î / L̄ of cells; empty: the same everywhere
    float scaleWithout_ = 1 / kThreshold;
    float average_ = 0;
};

} // namespace abbe
