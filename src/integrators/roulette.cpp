#include "integrators/roulette.h"

#include <cmath>
#include <numeric>

namespace abbe {

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

} // namespace

RouletteReference::RouletteReference(PixelBounds bounds) : bounds_(bounds) {}

void RouletteReference::update(const Film& film) {
    const auto count = static_cast<std::size_t>(bounds_.area());
    std::vector<float> image(count);
    double total = 0;
    for (int y = bounds_.y0; y < bounds_.y1; ++y)
        for (int x = bounds_.x0; x < bounds_.x1; ++x) {
            const double value = std::max(0.0, film.mean(x, y).y);
            image[static_cast<std::size_t>(y - bounds_.y0) * width() + static_cast<std::size_t>(x - bounds_.x0)] =
                static_cast<float>(value);
            total += value;
        }
    const float average = static_cast<float>(total / static_cast<double>(count));
    if (!(average > 0)) return; // nothing seen yet: keep every path as likely as its throughput
    boxFilter(image, bounds_.width(), bounds_.height(), 1, width());
    boxFilter(image, bounds_.height(), bounds_.width(), width(), 1);
    std::vector<float> sorted = image;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    const float least = std::max(*middle, 1e-3f * average);
    for (float& v : image) v = average / (kThreshold * std::max(v, least));
    scale_ = std::move(image);
}

} // namespace abbe
