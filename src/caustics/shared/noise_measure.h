// What pilots remember of light, and how much its noise counts.
#pragma once

#include "transport/roulette.h"

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace abbe {

// Where a light path of a pilot started.
struct LightStart {
    std::uint32_t light = 0;
    std::uint32_t target = 0; // one more than the number of what it was aimed at; 0: not aimed
    std::uint32_t part = 0;   // of the target's cone: cell of the finest AimGrid
};

// Light that one showed to the lens.
struct LightDeposit {
    LightStart start;
    bool spread = false;  // before it came here
    int x = 0, y = 0;     // pixel
    double luminance = 0; // that one of as many light paths as the frame has pixels brings to the pixel, without weight
    double stands = 1;    // for how many such paths
    double rho = 0;       // how many times as likely one camera path a pixel is to find the same
    std::uint32_t path = 0; // its number, of those that started in one part of a pilot
};

// As in the noise that a render shows and that its goal asks for (Film::relativeNoise): a variance counts over
// I² + (L̄/10)², where I is what the pixel shows and L̄ the mean of the frame. I is what camera paths or light paths of a
// pilot found, whichever is more: caustics that the former miss would count as noise in the dark.
class NoiseMeasure {
  public:
    // Cells of the frame in which light paths are summed up.
    static constexpr int kRow = 16;
    static constexpr std::size_t kCells = std::size_t{kRow} * kRow;

    // The reference is that of the frame. Deposits as heard, of light paths without weights.
    NoiseMeasure(PixelBounds frame, const RouletteReference&, std::span<const LightDeposit>);

    std::size_t cell(int x, int y) const;
    // One over the square of luminance; 0 where nobody saw any light at all. `seen`: the mean of more samples there.
    double weight(int x, int y, double seen = 0) const;
    // How much brighter than its pixel a camera path is that finds the same; infinite if none can.
    double brightness(const LightDeposit& d) const { return d.luminance * std::sqrt(weight(d.x, d.y)) / d.rho; }
    // Far brighter than its pixel, and rarer for camera paths than for light paths. All else is no noise to speak of:
    // light from next-event estimation varies by less, and most of its second moment is its mean.
    static constexpr double kBright = 3, kRare = 2;
    static bool isFirefly(double brightness, double rho) { return brightness > kBright && rho < kRare; }
    double mean() const { return mean_; } // L̄, luminance

  private:
    double shown(int x, int y) const;

    PixelBounds frame_;
    const RouletteReference& roulette_;
    std::vector<double> traced_; // what light paths bring to a pixel of each cell
    double mean_ = 0;
};

} // namespace abbe
