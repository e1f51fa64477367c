// How many samples each pixel takes, decided before the first one by a pilot.
#pragma once

#include "caustics/shared/kernel_jobs.h"
#include "render/film.h"
#include "render/integrator.h"

#include <array>
#include <cstdint>
#include <vector>

namespace abbe {

// A part of the frame. Looks at it are in two halves that share no sample, so that one can tell what the other is
// worth.
struct PlanCell {
    std::array<double, 2> variance{};  // of one sample's Y within a pixel, by half
    std::array<double, 2> luminance{}; // mean Y, likewise
    double rays = 0;                   // of one sample
    double pixels = 0;                 // how many it has
};

// A pilot of the whole frame that measures noise and cost. The frame in square cells of at least 8 × 8 pixels, at most
// 8192 of them, each seen through four of its pixels that hashing chooses. Depends on frame and seed alone, like
// PilotFilm.
class PlanPilot {
  public:
    static constexpr int kLooks = 4;             // pixels of a cell, two for each half
    static constexpr std::uint32_t kSamples = 4; // of each replicate of such a pixel
    static constexpr int kReplicates = 2;

    // One pixel as a film of its own, filtered as the image is. `film` outlives it.
    class Probe;

    PlanPilot(PixelBounds frame, std::uint64_t seed);

    int columns() const { return columns_; }
    int rows() const { return rows_; }
    int cellSize() const { return cellSize_; } // pixels
    PixelBounds frame() const { return frame_; }
    // The pixel of a look, and nothing else.
    PixelBounds pixelOf(int column, int row, int look) const;
    // Different cells may be added to from different threads at once.
    void add(int column, int row, int look, const Probe&, std::uint64_t rays);
    const PlanCell& cell(int column, int row) const { return cells_[index(column, row)]; }

  private:
    std::size_t index(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
    }
    PixelBounds boundsOf(int column, int row) const;

    PixelBounds frame_;
    std::uint64_t seed_;
    int cellSize_ = 8, columns_ = 0, rows_ = 0;
    std::vector<PlanCell> cells_;
};

class PlanPilot::Probe final : public Film {
  public:
    Probe(PixelBounds pixel, const Film& film) : pixel_(pixel), film_(film) {}
    PixelBounds bounds() const override { return pixel_; }
    int replicates() const override { return kReplicates; }
    FilterSample filter(Vec2 u) const noexcept override { return film_.filter(u); }
    void add(int, int, int replicate, const ExactXyz& sum, std::uint32_t samples) noexcept override {
        sums_[static_cast<std::size_t>(replicate)] += sum.y.value();
        samples_[static_cast<std::size_t>(replicate)] += samples;
    }
    Xyz mean(int, int) const noexcept override { return {}; }
    double relativeNoise() const override { return 0; }

    double luminance() const { return 0.5 * (meanOf(0) + meanOf(1)); }
    // Of one sample, without bias if samples were independent; those of a net have less, as in the image.
    double variance() const {
        const double difference = meanOf(0) - meanOf(1);
        return 0.5 * difference * difference * kSamples;
    }

  private:
    double meanOf(std::size_t replicate) const {
        return samples_[replicate] == 0 ? 0 : sums_[replicate] / samples_[replicate];
    }
    PixelBounds pixel_;
    const Film& film_;
    std::array<double, 2> sums_{};
    std::array<std::uint32_t, 2> samples_{};
};

// The number of samples of each pixel. Pixels take 2^k times the samples that are asked for, k = −2 … 3, so that a
// render of the same cost has the least mean of variance/(Y² + ε), which is what PixelFilm::relativeNoise() is about: n
// ∝ √(variance/((Y² + ε)·cost)). What the pilot says is averaged over neighbours, and believed as far as each half of
// it predicts the other; on an even frame that is not at all. The plan never changes and no sample of the pilot is in
// the image, so that each pixel is the mean of a number of samples that does not depend on them: unbiased [Kirk1991].
// It depends on frame, scene and seed alone.
class SamplingPlan final : public PixelSamples {
  public:
    static constexpr int kLeast = -2, kMost = 3;

    // All pixels alike.
    SamplingPlan() = default;
    explicit SamplingPlan(const PlanPilot&);

    bool even() const { return factors_.empty(); }
    // k of a pixel of the frame.
    int exponent(int x, int y) const;
    // Mean of 2^k over a rectangle.
    double meanFactor(PixelBounds) const;

    // The samples that stand for `nominal` ones. Ranges that follow each other make ranges that do, from 0 on, and an
    // aligned power of two stays one as long as it has a sample: a net. None is beyond 2^32 − 1.
    static SampleRange scaled(SampleRange nominal, int exponent);
    SampleRange of(int x, int y, SampleRange nominal) const override;

  private:
    float factorAt(float u, float v) const;

    PixelBounds frame_;
    int cellSize_ = 1, columns_ = 0, rows_ = 0;
    std::vector<float> factors_; // of cells, before they are rounded to powers of two; empty: even
};

} // namespace abbe
