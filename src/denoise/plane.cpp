#include "denoise/plane.h"

#include "base/check.h"
#include "base/parallel.h"

#include <algorithm>

namespace abbe {

Plane::Plane(int width, int height)
    : width_(width), height_(height), stride_(static_cast<std::size_t>(width + 2 * kBorder)),
      values_(stride_ * static_cast<std::size_t>(height + 2 * kBorder)) {}

Plane::Plane(int width, int height, std::span<const float> values) : Plane(width, height) {
    ABBE_CHECK(values.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (int y = 0; y < height; ++y) std::copy_n(values.data() + static_cast<std::ptrdiff_t>(y) * width, width, row(y));
    extend();
}

void Plane::extend() {
    for (int y = 0; y < height_; ++y) {
        float* r = row(y);
        std::fill(r - kBorder, r, r[0]);
        std::fill(r + width_, r + width_ + kBorder, r[width_ - 1]);
    }
    const auto copyRow = [&](int from, int to) { std::copy_n(row(from) - kBorder, stride_, row(to) - kBorder); };
    for (int i = 1; i <= kBorder; ++i) {
        copyRow(0, -i);
        copyRow(height_ - 1, height_ - 1 + i);
    }
}

std::vector<float> Plane::pixels() const {
    std::vector<float> values;
    values.reserve(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
    for (int y = 0; y < height_; ++y) values.insert(values.end(), row(y), row(y) + width_);
    return values;
}

namespace {

// Sums over `2·radius + 1` places `step` apart; both directions of a box are this.
void sumAlong(const float* from, std::ptrdiff_t step, int radius, int width, float scale, float* to) {
    for (int x = 0; x < width; x += kLanes) {
        Lanes sum{};
        for (int i = -radius; i <= radius; ++i) sum += load(from + x + i * step);
        store(to + x, sum * scale);
    }
}

} // namespace

Plane boxFilter(const Plane& source, int radius) {
    ABBE_CHECK(radius >= 0 && radius <= Plane::kBorder - kLanes);
    const int width = source.width(), height = source.height();
    const float scale = 1 / static_cast<float>(2 * radius + 1);
    Plane rows(width, height), result(width, height);
    const std::ptrdiff_t stride = rows.row(1) - rows.row(0);
    parallelFor(static_cast<std::size_t>(height), [&](std::size_t y) {
        sumAlong(source.row(static_cast<int>(y)), 1, radius, width, scale, rows.row(static_cast<int>(y)));
    });
    rows.extend();
    parallelFor(static_cast<std::size_t>(height), [&](std::size_t y) {
        sumAlong(rows.row(static_cast<int>(y)), stride, radius, width, scale, result.row(static_cast<int>(y)));
    });
    result.extend();
    return result;
}

void forEachTile(int width, int height, const std::function<void(const Tile&)>& body) {
    for (int round = 0; round < 4; ++round) {
        const int startX = (round & 1) * Tile::kSize, startY = (round >> 1) * Tile::kSize;
        constexpr int kStep = 2 * Tile::kSize;
        const int columns = std::max(0, (width - startX + kStep - 1) / kStep);
        const int rows = std::max(0, (height - startY + kStep - 1) / kStep);
        parallelFor(static_cast<std::size_t>(columns * rows), [&](std::size_t index) {
            const int i = static_cast<int>(index);
            Tile t{startX + i % columns * kStep, startY + i / columns * kStep, 0, 0};
            t.width = std::min(Tile::kSize, (width - t.x0 + kLanes - 1) / kLanes * kLanes);
            t.height = std::min(Tile::kSize, height - t.y0);
            body(t);
        });
    }
}

} // namespace abbe
