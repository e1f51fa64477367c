// Expected-contribution Russian roulette: paths live in proportion to what they can still add to their pixel.
#pragma once

#include "render/film.h"

#include <algorithm>
#include <vector>

namespace abbe {

// A coarse look at the whole frame before the render: what roulette goes by. The frame in square cells, at most 128 ×
// 128 of them, each seen through one of its pixels, chosen by hashing. Depends on the frame and the seed alone and
// never on the part of the image that is rendered, on threads or on goals, so that what is decided by it is decided
// alike in crops, continued renders and parts of a render.
class PilotFilm final : public Film {
  public:
    static constexpr std::uint32_t kSamples = 4; // of each cell

    PilotFilm(PixelBounds frame, std::uint64_t seed);

    int columns() const { return columns_; }
    int rows() const { return rows_; }
    int cellSize() const { return cellSize_; } // pixels
    PixelBounds frame() const { return frame_; }
    // The pixel of a cell, and nothing else, as bounds for a tile.
    PixelBounds pixelOf(int column, int row) const;
    // Whether any of its samples was taken.
    bool seen(int column, int row) const { return samples_[cell(column, row)] > 0; }
    // Y of a cell.
    float luminance(int column, int row) const;
    // What all samples of a cell took. Different cells may be recorded from different threads at once.
    void noteRays(int column, int row, std::uint64_t rays) { rays_[cell(column, row)] = static_cast<float>(rays); }
    // Of one sample, on average over the cells that a rectangle touches; beyond the frame, over those next to it.
    double rays(PixelBounds) const;

    PixelBounds bounds() const override { return frame_; }
    int replicates() const override { return 1; }
    // The pixel as it is, without a filter: cells are far coarser.
    FilterSample filter(Vec2 u) const noexcept override { return {{u.x - 0.5f, u.y - 0.5f}, 1}; }
    // Different cells may be added to from different threads at once.
    void add(int x, int y, int replicate, const ExactXyz& sum, std::uint32_t samples) noexcept override;
    Xyz mean(int x, int y) const noexcept override;
    double relativeNoise() const override { return 0; }

  private:
    std::size_t cell(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
    }
    PixelBounds frame_;
    std::uint64_t seed_;
    int cellSize_ = 2, columns_ = 0, rows_ = 0;
    std::vector<ExactXyz> sums_;
    std::vector<std::uint32_t> samples_;
    std::vector<float> rays_;
};

// What pixels are expected to show, from the pilot. A path of throughput β survives with
//   P = clamp(|β| L̄ / (t Î), 0.05, 1),
// where Î is the pilot around the pixel, 5×5 cells and linear between them (at least the frame's median, so that dark
// pixels do not keep every path alive) and L̄ its mean over the frame: the radiance that a continued path finds on
// average. The floor keeps the estimate unbiased and bounds the variance that roulette adds [Vorba2016, sec. 3].
class RouletteReference {
  public:
    static constexpr float kFloor = 0.05f;
    static constexpr float kThreshold = 0.2f; // t: docs/decisions/011-roulette.md has the figures of other values

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
    // Î of a pixel of that scale, likewise.
    float shown(float scale) const { return average_ / (kThreshold * scale); }
    static float survival(float meanThroughput, float scale) { return std::clamp(meanThroughput * scale, kFloor, 1.f); }

  private:
    PixelBounds frame_;
    int cellSize_ = 1, columns_ = 0, rows_ = 0;
    std::vector<float> expected_; // t Î / L̄ of cells; empty: the same everywhere
    float scaleWithout_ = 1 / kThreshold;
    float average_ = 0;
};

} // namespace abbe
