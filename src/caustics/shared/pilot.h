// What the pilots of a render are made with: their size, and films of their own.
#pragma once

#include "render/film.h"
#include "render/integrator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace abbe {

// Numbers of paths, pixels and places of the pilots of one size, RenderSettings::pilot. Sizes are kPilotStep apart in
// work, as far as the least numbers let them.
class PilotSize {
  public:
    static constexpr double kPilotStep = 4;

    // Requires 0 < size <= RenderSettings::kFullPilot.
    explicit PilotSize(const RenderSettings& settings)
        : effort_(std::pow(kPilotStep, settings.pilot - RenderSettings::kFullPilot)) {}

    // Of the work of the full pilot; a power of two.
    double effort() const { return effort_; }
    std::uint32_t count(std::uint32_t full, std::uint32_t least) const {
        return std::max(std::min(full, least), static_cast<std::uint32_t>(full * effort_));
    }
    // Of something along one of two axes.
    int side(int full, int least) const {
        return std::max(std::min(full, least), static_cast<int>(full * std::sqrt(effort_)));
    }

  private:
    double effort_;
};

// A plan that is forecast to gain less is not worth the risk of a rough forecast.
inline constexpr double kLeastGain = 1.15;

// The film of one pixel without a filter: keeps the last sum of luminance of each replicate.
class PilotPixel final : public Film {
  public:
    static constexpr int kMostReplicates = 4;

    // The pixels in the middles of the cells of an even grid over a frame, row by row.
    class Grid {
      public:
        // Requires: frame.area() > 0. At most `most` columns and rows.
        Grid(PixelBounds frame, int most)
            : frame_(frame), columns_(std::min(most, frame.width())), rows_(std::min(most, frame.height())) {}
        std::size_t size() const { return static_cast<std::size_t>(columns_ * rows_); }
        PixelBounds pixel(std::size_t i) const {
            const int column = static_cast<int>(i) % columns_, row = static_cast<int>(i) / columns_;
            const int x = frame_.x0 + (2 * column + 1) * frame_.width() / (2 * columns_);
            const int y = frame_.y0 + (2 * row + 1) * frame_.height() / (2 * rows_);
            return {x, y, x + 1, y + 1};
        }

      private:
        PixelBounds frame_;
        int columns_, rows_;
    };

    // Requires: 0 < replicates <= kMostReplicates.
    explicit PilotPixel(PixelBounds pixel, int replicates = kMostReplicates) : pixel_(pixel), replicates_(replicates) {}
    PixelBounds bounds() const override { return pixel_; }
    int replicates() const override { return replicates_; }
    FilterSample filter(Vec2 u) const noexcept override { return {{u.x - 0.5f, u.y - 0.5f}, 1}; }
    void add(int, int, int r, const ExactXyz& sum, std::uint32_t) noexcept override {
        y_[static_cast<std::size_t>(r)] = sum.y.value();
    }
    Xyz mean(int, int) const noexcept override { return {}; }
    double relativeNoise() const override { return 0; }

    double luminance(int replicate) const { return y_[static_cast<std::size_t>(replicate)]; }

  private:
    PixelBounds pixel_;
    int replicates_;
    std::array<double, kMostReplicates> y_{};
};

// A film that forgets all light, for looks ahead that listen or count.
class NullFilm final : public Film {
  public:
    explicit NullFilm(PixelBounds frame) : frame_(frame) {}
    PixelBounds bounds() const override { return frame_; }
    int replicates() const override { return 1; }
    FilterSample filter(Vec2 u) const noexcept override { return {{u.x - 0.5f, u.y - 0.5f}, 1}; }
    void add(int, int, int, const ExactXyz&, std::uint32_t) noexcept override {}
    Xyz mean(int, int) const noexcept override { return {}; }
    double relativeNoise() const override { return 0; }
    bool takesSplats() const override { return true; }
    bool takesMerged() const override { return true; }

  private:
    PixelBounds frame_;
};

} // namespace abbe
