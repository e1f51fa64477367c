// A reference in two halves from different seeds, and errors against it.
#pragma once

#include "study/seed_runs.h"

#include <span>
#include <vector>

namespace abbe {

// Interleaved linear RGB, row by row.
struct StudyImage {
    int width = 0, height = 0;
    std::vector<float> rgb; // 3 · width · height

    std::size_t pixels() const { return rgb.size() / 3; }
    bool sameSize(const StudyImage& o) const { return width == o.width && height == o.height; }
};

// relMSE = mean (x − a)(x − b)/(r² + ε) over all components, r = (a + b)/2, ε = 0.01 mean(r)². The noise of a and that
// of b are independent, so what they add to the error of x is zero on average.
class ReferencePair {
  public:
    // Requires equal sizes, at least one pixel.
    ReferencePair(StudyImage a, StudyImage b);

    const StudyImage& a() const { return a_; }
    const StudyImage& b() const { return b_; }
    const StudyImage& mean() const { return mean_; }
    // Of the mean of both: mean ((a − b)/2)²/(r² + ε).
    double relMse() const { return relMse_; }

    struct Error {
        double relMse = 0;
        double trimmed = 0;        // without the 0.1 % of pixels that add most
        std::vector<double> tiles; // relMSE in each tile
    };
    // Requires the size of the reference.
    Error measure(const StudyImage&) const;

    // (mean x − r)²/(r² + ε) of the image that seeds tend to, mean over the components: bias². `sum` adds up the images
    // of so many seeds and `tiles` the errors that measure() gave for them; what their noise adds is taken off, by
    //   Σ_{s≠t} (x_s − a)(x_t − b) = (Σx − na)(Σx − nb) − Σ (x_s − a)(x_s − b), over n(n − 1).
    // The interval is that of the mean over tiles, of which the noise is independent; unknown with few tiles or one
    // seed. Requires the size of the reference and that many tiles.
    Estimate biasSquared(const StudyImage& sum, std::span<const double> tiles, std::size_t seeds) const;

    // √ of the mean over the three components of (x − r)²/(r² + ε), for each pixel.
    std::vector<float> errorMap(const StudyImage&) const;

    static constexpr int kTile = 16; // pixels; larger than what a denoiser spreads noise over
    std::size_t tileCount() const { return tilePixels_.size(); }

  private:
    std::size_t tileOf(std::size_t pixel) const;
    double weight(std::size_t component) const { return static_cast<double>(weights_[component]); }

    StudyImage a_, b_, mean_;
    std::vector<float> weights_; // 1/(r² + ε), of components
    std::vector<double> tilePixels_;
    double relMse_ = 0;
};

} // namespace abbe
