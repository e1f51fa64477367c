#include "rendering/plan_pilot.h"

#include "base/check.h"
#include "math/hash.h"

#include <algorithm>

namespace abbe {

namespace {
constexpr std::int64_t kMostPlanCells = 8192;
}

PlanPilot::PlanPilot(PixelBounds frame, std::uint64_t seed) : frame_(frame), seed_(seed) {
    ABBE_CHECK(frame.area() > 0);
    const auto cells = [&](int pixels) { return (pixels + cellSize_ - 1) / cellSize_; };
    while (static_cast<std::int64_t>(cells(frame.width())) * cells(frame.height()) > kMostPlanCells) cellSize_ *= 2;
    columns_ = cells(frame.width());
    rows_ = cells(frame.height());
    cells_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    for (int row = 0; row < rows_; ++row)
        for (int column = 0; column < columns_; ++column)
            cells_[index(column, row)].pixels = static_cast<double>(boundsOf(column, row).area());
}

PixelBounds PlanPilot::boundsOf(int column, int row) const {
    const int x = frame_.x0 + column * cellSize_, y = frame_.y0 + row * cellSize_;
    return {x, y, std::min(x + cellSize_, frame_.x1), std::min(y + cellSize_, frame_.y1)};
}

// One in each quarter of the cell; looks 0 and 3, which are diagonal, are the first half.
PixelBounds PlanPilot::pixelOf(int column, int row, int look) const {
    const PixelBounds b = boundsOf(column, row);
    const std::uint64_t hash = combine64(combine64(seed_, index(column, row)), static_cast<std::uint64_t>(look));
    const auto within = [](std::uint32_t bits, int first, int end, int side) {
        const int middle = (first + end + 1) / 2; // of one pixel both quarters are that
        const int from = side == 0 || middle == end ? first : middle, to = side == 0 ? middle : end;
        return from +
               static_cast<int>((static_cast<std::uint64_t>(bits) * static_cast<std::uint64_t>(to - from)) >> 32);
    };
    const int x = within(static_cast<std::uint32_t>(hash), b.x0, b.x1, look % 2);
    const int y = within(static_cast<std::uint32_t>(hash >> 32), b.y0, b.y1, look / 2);
    return {x, y, x + 1, y + 1};
}

void PlanPilot::add(int column, int row, int look, const Probe& probe, std::uint64_t rays) {
    PlanCell& cell = cells_[index(column, row)];
    const std::size_t half = look == 0 || look == 3 ? 0 : 1;
    cell.variance[half] += probe.variance() / (0.5 * kLooks);
    cell.luminance[half] += probe.luminance() / (0.5 * kLooks);
    cell.rays += static_cast<double>(rays) / (kLooks * kReplicates * kSamples);
}

} // namespace abbe
