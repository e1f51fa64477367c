// A noisy picture as two independent halves; weights of NL-means: how much a neighbour's surroundings look like a
// pixel's, given their noise; and how wrong a denoised picture is, from its two halves.
#pragma once

#include "denoise/plane.h"

#include <array>
#include <span>
#include <vector>

namespace abbe {

// A noisy picture of one or several planes with the variance of each pixel, borders extended. The planes outlive it.
struct Guide {
    std::vector<const Plane*> values, variances;
    float epsilon = 0; // squared difference that counts as none, > 0
};

// The weights of one tile against a window of neighbours, at the bandwidth k = 2 of [Bitterli2016, eq. 5]; the weights
// of another k are these to the power of 4/k².
class PatchWeights {
  public:
    static constexpr int kPatchRadius = 1;

    // Requires windowRadius <= 9.
    explicit PatchWeights(int windowRadius);

    int windowRadius() const { return radius_; }
    void compute(const Guide& guide, const Tile& tile);
    // The weights of the tile's row y (from 0) for the neighbours (dx, dy); 0 where one of the two pixels lies outside
    // the picture.
    const float* row(int dx, int dy, int y) const { return weights_.data() + offset(dx, dy, y); }

  private:
    std::size_t offset(int dx, int dy, int y) const {
        const int side = 2 * radius_ + 1, neighbour = (dy + radius_) * side + dx + radius_;
        return static_cast<std::size_t>((neighbour * Tile::kSize + y) * Tile::kSize);
    }
    void measure(const Guide& guide, const Tile& tile, int dx, int dy);
    void average(const Tile& tile, int dx, int dy);
    void clip(const Guide& guide, const Tile& tile, int dx, int dy);

    int radius_;
    std::vector<float> weights_;
    std::vector<float> distances_; // of single pixels: the tile and a patch's radius around it
};

// Planes that belong together (R G B, or the components of a normal) from two halves of the samples, and the variance
// of each half, averaged over (2·radius + 1)² pixels: few enough to follow the noise, and enough that a single pixel of
// one half hardly takes part in what is made of the other. Borders are extended.
struct HalfBuffers {
    std::array<std::vector<Plane>, 2> halves;
    std::vector<Plane> variances;

    HalfBuffers(std::vector<Plane> first, std::vector<Plane> second, int radius);
    // One half and the variances, for weights; `epsilon` as in Guide.
    Guide guide(std::size_t half, float epsilon) const;
};

Guide guideOf(const std::vector<Plane>& values, const std::vector<Plane>& variances, float epsilon);

// The brightness at which compressed() turns from linear to logarithmic, where that of most pixels is near kTypical.
inline constexpr float kDark = 0.02f, kTypical = 0.2f;

// asinh(c/kDark): the noise of a path tracer goes with the light, and after this it is much alike in bright and dark
// places, so that neither seems noisy because of the other. Borders are extended.
std::vector<Plane> compressed(const std::vector<Plane>& colours);

// Each half of a picture after denoising.
using DenoisedHalves = std::array<ColourPlanes, 2>;

// For every pixel and channel an estimate without bias of the squared error of the mean of both halves, as long as what
// was made of one half is independent of the other [Bitterli2016, §5.3]. With A, B the noisy halves, D_A, D_B the
// denoised ones and µ the truth: (D_A − B)² − Var B expects (D_A − µ)², likewise with A and B exchanged, and
//   ((D_A + D_B)/2 − µ)² = ((D_A − µ)² + (D_B − µ)²)/2 − (D_A − D_B)²/4.
// Single values are as noisy as the picture, and may be negative. Borders are extended.
ColourPlanes squaredError(const HalfBuffers& noisy, const DenoisedHalves& denoised);

// (D_A − D_B)²/4, the part of the error that is noise, mean over the channels. Borders are extended.
Plane remainingNoise(const DenoisedHalves& denoised);

} // namespace abbe
