#include "transport/roulette.h"

#include "base/check.h"
#include "math/hash.h"

#include <algorithm>
#include <cmath>
#include <numeric>

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

namespace {

// Running mean of width 5 along rows of `step` distance; ends use what is there.
void boxFilter(std::vector<float>& data, int count, int lines, std::size_t step, std::size_t lineStep) {
    std::vector<float> line(static_cast<std::size_t>(count));
    for (int l = 0; l < lines; ++l) {
        float* base = data.data() + static_cast<std::size_t>(l) * lineStep;
        for (int i = 0; i < count; ++i) line[static_cast<std::size_t>(i)] = base[static_cast<std::size_t>(i) * step];
        for (int i = 0; i < count; ++i) {
            const int first = std::max(0, i - 2), last = std::min(count - 1, i + 2);
            float sum = 0;
            for (int k = first; k <= last; ++k) sum += line[static_cast<std::size_t>(k)];
            base[static_cast<std::size_t>(i) * step] = sum / static_cast<float>(last - first + 1);
        }
    }
}

// One sample in a thousand may be a thousand times as bright as the rest, and would keep the paths around it from
// living: what lies far beyond nearly all of the frame counts as bright and no more.
void limitOutliers(std::vector<float>& image) {
    std::vector<float> sorted = image;
    const auto high = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() * 19 / 20);
    std::nth_element(sorted.begin(), high, sorted.end());
    if (const float most = 8 * *high; most > 0)
        for (float& v : image) v = std::min(v, most);
}

float medianOf(std::vector<float> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

} // namespace

RouletteReference::RouletteReference(const PilotFilm& pilot)
    : frame_(pilot.frame()), cellSize_(pilot.cellSize()), columns_(pilot.columns()), rows_(pilot.rows()) {
    std::vector<float> image;
    for (int row = 0; row < rows_; ++row)
        for (int column = 0; column < columns_; ++column) image.push_back(pilot.luminance(column, row));
    limitOutliers(image);
    const double total = std::accumulate(image.begin(), image.end(), 0.0);
    const auto average = static_cast<float>(total / static_cast<double>(image.size()));
    if (!(average > 0)) return; // nothing seen: keep every path as likely as its throughput
    average_ = average;
    const auto width = static_cast<std::size_t>(columns_);
    boxFilter(image, columns_, rows_, 1, width);
    boxFilter(image, rows_, columns_, width, 1);
    const float least = std::max(medianOf(image), 1e-3f * average);
    for (float& v : image) v = kThreshold * std::max(v, least) / average;
    expected_ = std::move(image);
}

float RouletteReference::scale(int x, int y) const {
    if (expected_.empty()) return scaleWithout_;
    // Between the centres of cells.
    const auto place = [this](int pixel, int first, int count) {
        const float at = (static_cast<float>(pixel - first) + 0.5f) / static_cast<float>(cellSize_) - 0.5f;
        return std::clamp(at, 0.f, static_cast<float>(count - 1));
    };
    const float u = place(x, frame_.x0, columns_), v = place(y, frame_.y0, rows_);
    const int column = static_cast<int>(u), row = static_cast<int>(v);
    const auto at = [this](int c, int r) {
        return expected_[static_cast<std::size_t>(std::min(r, rows_ - 1)) * static_cast<std::size_t>(columns_) +
                         static_cast<std::size_t>(std::min(c, columns_ - 1))];
    };
    const float s = u - static_cast<float>(column), t = v - static_cast<float>(row);
    const float upper = at(column, row) * (1 - s) + at(column + 1, row) * s;
    const float lower = at(column, row + 1) * (1 - s) + at(column + 1, row + 1) * s;
    return 1 / (upper * (1 - t) + lower * t);
}

} // namespace abbe
