#include "transport/pilot_film.h"

#include "base/check.h"
#include "math/hash.h"

#include <algorithm>

namespace abbe {

namespace {
constexpr std::int64_t kMaxCells = 128 * 128;
}

PilotFilm::PilotFilm(PixelBounds frame, std::uint64_t seed) : frame_(frame), seed_(seed) {
    ABBE_CHECK(frame.area() > 0);
    const auto cells = [&](int pixels) { return (pixels + cellSize_ - 1) / cellSize_; };
    while (static_cast<std::int64_t>(cells(frame.width())) * cells(frame.height()) > kMaxCells) cellSize_ *= 2;
    columns_ = cells(frame.width());
    rows_ = cells(frame.height());
    sums_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    samples_.resize(sums_.size());
    rays_.resize(sums_.size());
}

PixelBounds PilotFilm::pixelOf(int column, int row) const {
    const std::uint64_t hash = combine64(seed_, cell(column, row));
    const auto within = [&](std::uint32_t bits, int first, int end) {
        const int left = std::min(cellSize_, end - first); // cells at the right and lower borders may be cut
        return first + static_cast<int>((static_cast<std::uint64_t>(bits) * static_cast<std::uint64_t>(left)) >> 32);
    };
    const int x = within(static_cast<std::uint32_t>(hash), frame_.x0 + column * cellSize_, frame_.x1);
    const int y = within(static_cast<std::uint32_t>(hash >> 32), frame_.y0 + row * cellSize_, frame_.y1);
    return {x, y, x + 1, y + 1};
}

float PilotFilm::luminance(int column, int row) const {
    const std::size_t i = cell(column, row);
    return samples_[i] == 0 ? 0 : static_cast<float>(std::max(0.0, sums_[i].y.value()) / samples_[i]);
}

double PilotFilm::rays(PixelBounds b) const {
    const auto near = [this](int pixel, int first, int count) { // the film may reach beyond the frame
        return std::clamp((pixel - first) / cellSize_, 0, count - 1);
    };
    const int left = near(b.x0, frame_.x0, columns_), right = near(b.x1 - 1, frame_.x0, columns_);
    const int top = near(b.y0, frame_.y0, rows_), bottom = near(b.y1 - 1, frame_.y0, rows_);
    double sum = 0;
    for (int row = top; row <= bottom; ++row)
        for (int column = left; column <= right; ++column) sum += static_cast<double>(rays_[cell(column, row)]);
    return sum / ((right - left + 1) * (bottom - top + 1) * kSamples);
}

void PilotFilm::add(int x, int y, int, const ExactXyz& sum, std::uint32_t samples) noexcept {
    const std::size_t i = cell((x - frame_.x0) / cellSize_, (y - frame_.y0) / cellSize_);
    sums_[i] += sum;
    samples_[i] += samples;
}

Xyz PilotFilm::mean(int x, int y) const noexcept {
    const std::size_t i = cell((x - frame_.x0) / cellSize_, (y - frame_.y0) / cellSize_);
    return samples_[i] == 0 ? Xyz{} : sums_[i].value() * (1.0 / samples_[i]);
}

} // namespace abbe
