// The pixel's reconstruction filter, drawn from rather than convolved with [Ernst2006].
#pragma once

#include "render/film.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

namespace abbe {

enum class FilterShape : std::uint8_t { box, triangle, gaussian, blackmanHarris, mitchell };

// The name in a scene file.
std::string_view name(FilterShape);
std::optional<FilterShape> findFilter(std::string_view name);
// Half the width in pixels when a scene gives none.
double defaultRadius(FilterShape);

// Separable f(x) f(y), zero beyond the radius:
//   box 1 · triangle 1 − |x|/r · gaussian exp(−x²/2σ²), σ = r/3 · blackman-harris the four-term window [Harris1978]
//   mitchell B = C = 1/3 stretched to r [Mitchell1988]
// Samples carry weight 1, except for mitchell, whose negative part is a sixteenth of the samples with a weight of its
// own (see pixel_filter.cpp): weights average to exactly 1 over any stratified set whose size is a multiple of 16, and
// in expectation over any set at all. Immutable; shared between threads.
class PixelFilter {
  public:
    // Requires radius > 0.
    PixelFilter(FilterShape, double radius);

    // Requires u in [0, 1)².
    FilterSample sample(Vec2 u) const noexcept;
    // f(x) over its integral, from a table: within 2e-6 of the largest; 0 beyond the radius.
    float weight(float x) const noexcept {
        const float place = std::abs(x) * perCell_;
        if (!(place <= static_cast<float>(kWeights))) return 0;
        const auto cell = std::min(static_cast<std::size_t>(place), std::size_t{kWeights - 1});
        return weights_[cell] + (weights_[cell + 1] - weights_[cell]) * (place - static_cast<float>(cell));
    }
    double radius() const { return radius_; }
    FilterShape shape() const { return shape_; }
    // f(x), not normalised; x in pixels from the centre.
    static double evaluate(FilterShape, double radius, double x);

    // Draws |x| from a density that falls with |x|. The table is uniform in the square root of the mass beyond |x|,
    // which resolves tails and makes a linearly falling density (triangle) exact.
    class Magnitude {
      public:
        Magnitude() = default;
        // Distributes |x| over [begin, end] in proportion to |f|.
        Magnitude(FilterShape, double radius, double begin, double end);
        // Signed x for u in [0, 1).
        float sample(float u) const noexcept;
        double mass() const { return mass_; } // ∫ |f| over [begin, end]

      private:
        static constexpr int kCells = 512;
        std::vector<float> table_;
        double mass_ = 0;
    };

  private:
    FilterSample sampleSigned(Vec2 u) const noexcept;

    static constexpr int kWeights = 1024;

    FilterShape shape_;
    double radius_;
    float perCell_; // of a pixel
    std::vector<float> weights_;
    Magnitude positive_, negative_;
    float bothNegative_ = 0;                        // share of the positive part where f(x) and f(y) are both negative
    float positiveWeight_ = 1, negativeWeight_ = 0; // of mitchell's two parts
};

} // namespace abbe
