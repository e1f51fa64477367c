#include "caustics/shared/noise_measure.h"

#include "caustics/shared/pilot.h"

#include <algorithm>

namespace abbe {

NoiseMeasure::NoiseMeasure(PixelBounds frame, const RouletteReference& roulette, std::span<const LightDeposit> deposits)
    : frame_(frame), roulette_(roulette), traced_(kCells) {
    std::vector<double> columns(kRow), rows(kRow);
    for (int x = frame.x0; x < frame.x1; ++x) ++columns[cell(x, frame.y0) % kRow];
    for (int y = frame.y0; y < frame.y1; ++y) ++rows[cell(frame.x0, y) / kRow];
    for (const LightDeposit& d : deposits) {
        const std::size_t i = cell(d.x, d.y);
        traced_[i] += d.luminance * d.stands / (columns[i % kRow] * rows[i / kRow]);
    }
    constexpr int kLooks = 64;
    const PilotPixel::Grid grid(frame, kLooks);
    for (std::size_t i = 0; i < grid.size(); ++i)
        mean_ += shown(grid.pixel(i).x0, grid.pixel(i).y0) / static_cast<double>(grid.size());
}

std::size_t NoiseMeasure::cell(int x, int y) const {
    const int column = kRow * (x - frame_.x0) / frame_.width(), row = kRow * (y - frame_.y0) / frame_.height();
    return static_cast<std::size_t>(row * kRow + column);
}

double NoiseMeasure::shown(int x, int y) const {
    const double camera = static_cast<double>(roulette_.average()) /
                          (static_cast<double>(roulette_.scale(x, y) * RouletteReference::kThreshold));
    return std::max(camera, traced_[cell(x, y)]);
}

double NoiseMeasure::weight(int x, int y, double seen) const {
    constexpr double kDark = 0.01; // as Film::relativeNoise
    return mean_ > 0 ? 1 / (square(std::max(shown(x, y), seen)) + kDark * square(mean_)) : 0;
}

} // namespace abbe
