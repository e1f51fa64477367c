// What noise at a pixel counts, before there is a picture.
#pragma once

#include "integrators/light_deposit.h"
#include "integrators/roulette.h"

#include <span>
#include <vector>

namespace abbe {

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
    // One over the square of luminance; 0 where nobody saw any light at all.
    double weight(int x, int y) const;
    double mean() const { return mean_; } // L̄, luminance

  private:
    double shown(int x, int y) const;

    PixelBounds frame_;
    const RouletteReference& roulette_;
    std::vector<double> traced_; // what light paths bring to a pixel of each cell
    double mean_ = 0;
};

} // namespace abbe
