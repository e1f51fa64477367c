#include "study/reference_pair.h"

#include "base/check.h"
#include "film/pixel_film.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

constexpr double kEpsilon = 0.01;
constexpr double kTail = 0.001;
constexpr std::size_t kFewestTiles = 6;

double withoutTail(std::vector<double> values) {
    const auto n = static_cast<double>(values.size());
    const auto kept = std::max<std::ptrdiff_t>(1, std::lround(std::floor(n * (1 - kTail))));
    if (kept < std::ssize(values)) std::nth_element(values.begin(), values.begin() + kept, values.end());
    double sum = 0;
    for (std::ptrdiff_t i = 0; i < kept; ++i) sum += values[static_cast<std::size_t>(i)];
    return sum / static_cast<double>(kept);
}

} // namespace

ReferencePair::ReferencePair(StudyImage a, StudyImage b) : a_(std::move(a)), b_(std::move(b)), mean_(a_) {
    ABBE_CHECK(a_.sameSize(b_) && !a_.rgb.empty());
    const std::size_t components = a_.rgb.size();
    double sum = 0;
    for (std::size_t c = 0; c < components; ++c) {
        mean_.rgb[c] = static_cast<float>((static_cast<double>(a_.rgb[c]) + b_.rgb[c]) / 2);
        sum += mean_.rgb[c];
    }
    const double average = sum / static_cast<double>(components);
    const double epsilon = average != 0 ? kEpsilon * average * average : 1;
    for (std::size_t c = 0; c < components; ++c) {
        const double r = mean_.rgb[c], half = (static_cast<double>(a_.rgb[c]) - b_.rgb[c]) / 2;
        weights_.push_back(static_cast<float>(1 / (r * r + epsilon)));
        relMse_ += half * half * weight(c) / static_cast<double>(components);
    }
    const auto across = static_cast<std::size_t>((a_.width + kTile - 1) / kTile);
    tilePixels_.resize(across * static_cast<std::size_t>((a_.height + kTile - 1) / kTile));
    for (std::size_t i = 0; i < a_.pixels(); ++i) tilePixels_[tileOf(i)] += 1;
}

std::size_t ReferencePair::tileOf(std::size_t pixel) const {
    const auto width = static_cast<std::size_t>(a_.width), tile = static_cast<std::size_t>(kTile);
    return pixel / width / tile * ((width + tile - 1) / tile) + pixel % width / tile;
}

ReferencePair::Error ReferencePair::measure(const StudyImage& image) const {
    ABBE_CHECK(image.sameSize(a_));
    Error error;
    error.tiles.resize(tilePixels_.size());
    std::vector<double> pixels(image.pixels());
    double sum = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        for (std::size_t c = 3 * i; c < 3 * i + 3; ++c) {
            const double x = image.rgb[c];
            pixels[i] += (x - a_.rgb[c]) * (x - b_.rgb[c]) * weight(c) / 3;
        }
        sum += pixels[i];
        error.tiles[tileOf(i)] += pixels[i];
    }
    error.relMse = sum / static_cast<double>(pixels.size());
    for (std::size_t t = 0; t < error.tiles.size(); ++t) error.tiles[t] /= tilePixels_[t];
    error.trimmed = withoutTail(std::move(pixels));
    return error;
}

Estimate ReferencePair::biasSquared(const StudyImage& sum, std::span<const double> tiles, std::size_t seeds) const {
    ABBE_CHECK(sum.sameSize(a_) && tiles.size() == tilePixels_.size());
    if (seeds < 2) return {};
    const auto n = static_cast<double>(seeds);
    std::vector<double> bias(tiles.size()); // of each tile, summed over its pixels
    for (std::size_t i = 0; i < sum.pixels(); ++i)
        for (std::size_t c = 3 * i; c < 3 * i + 3; ++c) {
            const double x = sum.rgb[c];
            bias[tileOf(i)] += (x - n * a_.rgb[c]) * (x - n * b_.rgb[c]) * weight(c) / 3;
        }
    const auto pixels = static_cast<double>(sum.pixels());
    const auto count = static_cast<double>(tiles.size());
    std::vector<double> shares; // whose plain mean is the mean over pixels
    for (std::size_t t = 0; t < tiles.size(); ++t)
        shares.push_back((bias[t] - tiles[t] * tilePixels_[t]) / (n * (n - 1)) * count / pixels);
    double mean = 0, squares = 0;
    for (const double v : shares) mean += v / count;
    for (const double v : shares) squares += (v - mean) * (v - mean);
    Estimate result{mean};
    if (tiles.size() < kFewestTiles) return result;
    const double half =
        studentFactor95(static_cast<int>(tiles.size()) - 1) * std::sqrt(squares / (count * (count - 1)));
    result.low = mean - half;
    result.high = mean + half;
    return result;
}

std::vector<float> ReferencePair::errorMap(const StudyImage& image) const {
    ABBE_CHECK(image.sameSize(a_));
    std::vector<float> map(image.pixels());
    for (std::size_t i = 0; i < map.size(); ++i) {
        double sum = 0;
        for (std::size_t c = 3 * i; c < 3 * i + 3; ++c) {
            const double off = static_cast<double>(image.rgb[c]) - mean_.rgb[c];
            sum += off * off * weight(c) / 3;
        }
        map[i] = static_cast<float>(std::sqrt(sum));
    }
    return map;
}

} // namespace abbe
