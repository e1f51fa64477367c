// The measure of relative errors.
#pragma once

#include "math/vec.h"

#include <cstddef>
#include <span>

namespace abbe {

// (x − t)²/((x² + t²)/2 + ε) of an image's x and the truth's t, ε = 0.01 (mean of the image)²: where both are near each
// other that is relMSE, and a pixel where they are not counts twice at most, whichever of them is too large. So a few
// pixels at the edges of lamps are not all that the error of an image says.
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

} // namespace abbe
