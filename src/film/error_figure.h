// One way to say how far an image is from its limit, with what is known about that figure itself.
#pragma once

#include "math/vec.h"
#include "render/film.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace abbe {

struct ErrorFigure {
    double value = 0;         // root mean square over the pixels
    double low = 0, high = 0; // interval of 95 % for the error that this image has
    std::int64_t pixels = 0;  // with an estimate
    // The tile with the largest estimate of its own. Its value is less sure than that of the image.
    struct Tile {
        PixelBounds pixels;
        double value = 0;
    } worst;
    // How heavy the tail of the pixels' estimates is (TailEstimate): k of the Pareto distribution, and what is expected
    // of the squared error that no sample has met, over the squared error. `high` has room for it.
    double tail = 0, unseen = 0;
    // That were judged by themselves, and of them those whose own estimate lacks much.
    std::int64_t tiles = 0, untrustedTiles = 0;

    bool holds(double error) const { return low <= error && error <= high; }
};

// Adds up estimates of pixels' squared errors to a figure for the image.
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

// The measure of relative errors.
// (x − t)²/((x² + t²)/2 + ε) of an image's x and the truth's t, ε = 0.01 (mean of the image)²: where both are near each
// other that is relMSE, and a pixel where they are not counts twice at most, whichever of them is too large. So a few
// pixels at the edges of lights are not all that the error of an image says.
class RelativeError {
  public:
    explicit RelativeError(double mean) : epsilon_(0.01 * square(mean)) {}
    // Of the mean of a plane.
    explicit RelativeError(std::span<const float> plane);

    double squared(double x, double t) const { return relative(square(x - t), x, t); }
    // A squared difference, perhaps without a part that is noise, of the same two.
    double relative(double squaredDifference, double x, double t) const {
        const double reference = (square(x) + square(t)) / 2 + epsilon_;
        return reference > 0 ? squaredDifference / reference : 0; // black images
    }

  private:
    double epsilon_;
};

inline RelativeError::RelativeError(std::span<const float> plane)
    : RelativeError([plane] {
          double sum = 0;
          for (const float v : plane) sum += static_cast<double>(v);
          return plane.empty() ? 0 : sum / static_cast<double>(plane.size());
      }()) {}

// Whether few values carry a sum of squares, and how much of it may not have been met yet.

// Errors are estimated from samples, and know nothing of bright ones that are too rare to have been met: a glossy
// surface that gathers a small light sends some of its light along paths that one sample in a million finds. The sizes
// of those that were met tell of the others. The largest values are fitted by a generalised Pareto distribution
// [Zhang2009], whose shape k is that of Pareto smoothed importance sampling [Vehtari2024]: beyond k = 1/4 their fourth
// moment has no bound, so that an interval made of it is too narrow; beyond 1/2 neither has their variance.
struct TailEstimate {
    // With more than this unseen, over the sum of squares, an error that was stated from it cannot be trusted: it may
    // be a quarter larger.
    static constexpr double kTrusted = 0.5;
    static constexpr std::size_t kLeast = 100; // values; fewer do not tell

    double shape = 0;   // k
    double largest = 0; // share of the largest value in the sum of squares
    // What is expected of the sum of squares beyond the largest value, over the sum: 0 where the tail is light.
    double unseen = 0;

    // Of sizes that are not negative; changes their order. Nothing for fewer than kLeast, or if hardly any is above 0.
    static std::optional<TailEstimate> of(std::vector<float>& sizes);
};

} // namespace abbe
