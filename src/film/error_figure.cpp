#include "film/error_figure.h"

#include "film/pixel_film.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <span>

namespace abbe {

void ErrorSum::closeTile() {
    if (tilePixels_ == 0) return;
    tile_.value = tileSum_ / static_cast<double>(tilePixels_);
    if (pixels_ == 0 || tile_.value > worst_.value) worst_ = tile_;
    pixels_ += tilePixels_;
    sum_ += tileSum_;
    tilePixels_ = 0;
    tileSum_ = 0;
}

void ErrorSum::append(ErrorSum next) {
    closeTile();
    next.closeTile();
    if (next.pixels_ == 0) return;
    if (pixels_ == 0 || next.worst_.value > worst_.value) worst_ = next.worst_;
    pixels_ += next.pixels_;
    sum_ += next.sum_;
    squares_ += next.squares_;
}

// The interval is one for the logarithm: error and estimate vary alike (for normal halves their
// ratio has the distribution F(n, n)), and neither is negative. Where few pixels carry all, Student's factor for their
// number takes the place of the normal one.
ErrorFigure ErrorSum::figure() const {
    ErrorSum all = *this;
    all.closeTile();
    ErrorFigure figure;
    figure.pixels = all.pixels_;
    if (all.pixels_ == 0) return figure;
    figure.worst = all.worst_;
    figure.worst.value = std::sqrt(figure.worst.value);
    if (!(all.sum_ > 0)) return figure;
    figure.value = std::sqrt(all.sum_ / static_cast<double>(all.pixels_));
    const double carried = all.sum_ / all.squares_ * all.sum_; // by so many pixels, were they alike
    const double variance = 4.0 / 3 / carried;                 // of the squared error, relative
    const int degrees = static_cast<int>(std::clamp(std::floor(carried), 1.0, 1e6));
    const double factor = std::exp(studentFactor95(degrees) * std::sqrt(std::log1p(variance)) / 2);
    figure.low = figure.value / factor;
    figure.high = figure.value * factor;
    return figure;
}

namespace {

constexpr std::size_t kLeastTail = 10; // values to fit
constexpr double kLightTail = 0.25;    // shape up to which the fourth moment is finite
constexpr double kLeastDivisor = 0.2;  // of the mean beyond the largest: shapes are known to a tenth at best

double paretoShape(double theta, std::span<const double> excesses) {
    double sum = 0;
    for (const double x : excesses) sum += std::log1p(-theta * x);
    return sum / static_cast<double>(excesses.size());
}

// The posterior mean of θ = −k/σ by [Zhang2009, eq. 4 to 6], over a grid from quantiles, and the shape that goes with
// it, drawn towards 1/2 as if by ten more values [Vehtari2024, app. G]. Of ascending values above 0.
double fittedShape(std::span<const double> excesses) {
    const auto n = static_cast<double>(excesses.size());
    const auto points = static_cast<std::size_t>(30 + std::floor(std::sqrt(n)));
    const double quartile = excesses[static_cast<std::size_t>(n / 4 + 0.5) - 1];
    std::vector<double> thetas, logLikelihoods;
    for (std::size_t i = 1; i <= points; ++i) {
        const double spread = 1 - std::sqrt(static_cast<double>(points) / (static_cast<double>(i) - 0.5));
        const double theta = 1 / excesses.back() + spread / (3 * quartile);
        const double k = paretoShape(theta, excesses);
        thetas.push_back(theta);
        logLikelihoods.push_back(n * (std::log(-theta / k) - k - 1));
    }
    const double most = *std::max_element(logLikelihoods.begin(), logLikelihoods.end());
    double weights = 0, mean = 0;
    for (std::size_t i = 0; i < points; ++i) {
        const double weight = std::exp(logLikelihoods[i] - most);
        weights += weight;
        mean += weight * thetas[i];
    }
    constexpr double kPriorValues = 10, kPriorShape = 0.5;
    return (n * paretoShape(mean / weights, excesses) + kPriorValues * kPriorShape) / (n + kPriorValues);
}

// The largest values less a threshold, ascending; as many as [Vehtari2024] takes.
std::vector<double> excessesOf(std::vector<float>& sizes) {
    const auto n = static_cast<double>(sizes.size());
    const auto count = static_cast<std::ptrdiff_t>(std::min(0.2 * n, 3 * std::sqrt(n)));
    std::nth_element(sizes.begin(), sizes.begin() + count, sizes.end(), std::greater());
    const double threshold = sizes[static_cast<std::size_t>(count)];
    std::vector<double> excesses;
    for (auto v = sizes.begin(); v != sizes.begin() + count; ++v)
        if (*v > threshold) excesses.push_back(*v - threshold);
    std::sort(excesses.begin(), excesses.end());
    return excesses;
}

} // namespace

// Of n values about one lies beyond the largest that n values have; of a Pareto tail its square is that of the largest
// over 1 − 2k in the mean.
std::optional<TailEstimate> TailEstimate::of(std::vector<float>& sizes) {
    if (sizes.size() < kLeast) return std::nullopt;
    double squares = 0, largest = 0;
    for (const float v : sizes) {
        squares += static_cast<double>(v) * static_cast<double>(v);
        largest = std::max(largest, static_cast<double>(v));
    }
    if (!(squares > 0)) return std::nullopt;
    const std::vector<double> excesses = excessesOf(sizes);
    if (excesses.size() < kLeastTail) return std::nullopt;
    TailEstimate tail{fittedShape(excesses), largest * largest / squares, 0};
    if (tail.shape > kLightTail) tail.unseen = tail.largest / std::max(1 - 2 * tail.shape, kLeastDivisor);
    return tail;
}

} // namespace abbe
