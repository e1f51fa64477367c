#include "io/flip_filters.h"

#include "math/vec.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace abbe {

namespace {

// Values of a function at −radius … radius.
template <typename Function> std::vector<double> sampled(int radius, Function&& function) {
    std::vector<double> values;
    for (int x = -radius; x <= radius; ++x) values.push_back(function(static_cast<double>(x)));
    return values;
}

double sumOf(const std::vector<double>& values) {
    double sum = 0;
    for (const double v : values) sum += v;
    return sum;
}

std::vector<float> scaled(const std::vector<double>& values, double factor) {
    std::vector<float> result;
    for (const double v : values) result.push_back(static_cast<float>(v * factor));
    return result;
}

// Positive weights add up to 1 and negative ones to −1, so that no detector exceeds 1 on values 0 … 1.
std::vector<float> balanced(const std::vector<double>& values) {
    double positive = 0, negative = 0;
    for (const double v : values) (v > 0 ? positive : negative) += std::abs(v);
    std::vector<float> result;
    for (const double v : values) result.push_back(static_cast<float>(v / (v > 0 ? positive : negative)));
    return result;
}

} // namespace

FlipFilters::FlipFilters(double pixelsPerDegree) {
    // The sensitivities in frequency, sums of Gaussians a √(π/b) exp(−π² x²/b) in degrees [Andersson2020, table 1].
    constexpr double kAchromatic = 0.0047, kRedGreen = 0.0053, kYellowWide = 0.04, kYellowNarrow = 0.025;
    constexpr double kYellowWideHeight = 34.1, kYellowNarrowHeight = 13.5;
    const int eye = static_cast<int>(std::ceil(3 * std::sqrt(kYellowWide / (2 * kPiD * kPiD)) * pixelsPerDegree));
    const auto gaussian = [&](double b) {
        return sampled(eye, [&](double x) { return std::exp(-square(kPiD * x / pixelsPerDegree) / b); });
    };
    const std::vector<double> a = gaussian(kAchromatic), r = gaussian(kRedGreen);
    achromatic_ = scaled(a, 1 / sumOf(a));
    redGreen_ = scaled(r, 1 / sumOf(r));
    // Two separable kernels whose sum is 1: each carries the root of its weight along either axis.
    const std::vector<double> wide = gaussian(kYellowWide), narrow = gaussian(kYellowNarrow);
    const double wideHeight = kYellowWideHeight * std::sqrt(kPiD / kYellowWide);
    const double narrowHeight = kYellowNarrowHeight * std::sqrt(kPiD / kYellowNarrow);
    const double total = wideHeight * square(sumOf(wide)) + narrowHeight * square(sumOf(narrow));
    wideYellow_ = scaled(wide, std::sqrt(wideHeight / total));
    narrowYellow_ = scaled(narrow, std::sqrt(narrowHeight / total));

    constexpr double kFeatureWidth = 0.082; // degrees from peak to trough of the edge detector
    const double sigma = 0.5 * kFeatureWidth * pixelsPerDegree;
    const int feature = static_cast<int>(std::ceil(3 * sigma));
    const auto bell = [&](double x) { return std::exp(-x * x / (2 * sigma * sigma)); };
    const std::vector<double> blur = sampled(feature, bell);
    featureBlur_ = scaled(blur, 1 / sumOf(blur));
    edge_ = balanced(sampled(feature, [&](double x) { return -x * bell(x); }));
    point_ = balanced(sampled(feature, [&](double x) { return (square(x / sigma) - 1) * bell(x); }));
    radius_ = std::max(eye, feature);
}

std::vector<float> FlipFilters::separable(const FlipPlane& plane, const Kernel& alongX, const Kernel& alongY) const {
    const int rx = static_cast<int>(alongX.size()) / 2, ry = static_cast<int>(alongY.size()) / 2;
    const int width = plane.width, wanted = plane.height - 2 * radius_;
    FlipPlane across(width, wanted + 2 * ry);
    std::vector<float> padded(static_cast<std::size_t>(width + 2 * rx));
    for (int y = 0; y < across.height; ++y) {
        const float* from = plane.row(y + radius_ - ry);
        std::fill_n(padded.begin(), rx, from[0]);
        std::copy_n(from, width, padded.begin() + rx);
        std::fill_n(padded.begin() + rx + width, rx, from[width - 1]);
        float* to = across.row(y);
        for (std::size_t k = 0; k < alongX.size(); ++k)
            for (int x = 0; x < width; ++x) to[x] += alongX[k] * padded[k + static_cast<std::size_t>(x)];
    }
    FlipPlane result(width, wanted);
    for (int y = 0; y < wanted; ++y)
        for (std::size_t k = 0; k < alongY.size(); ++k) {
            const float* from = across.row(y + static_cast<int>(k));
            float* to = result.row(y);
            for (int x = 0; x < width; ++x) to[x] += alongY[k] * from[x];
        }
    return std::move(result.values);
}

std::vector<float> FlipFilters::features(const FlipPlane& plane, const Kernel& detector) const {
    std::vector<float> x = separable(plane, detector, featureBlur_);
    const std::vector<float> y = separable(plane, featureBlur_, detector);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::hypot(x[i], y[i]);
    return x;
}

std::vector<float> FlipFilters::achromatic(const FlipPlane& p) const { return separable(p, achromatic_, achromatic_); }
std::vector<float> FlipFilters::redGreen(const FlipPlane& p) const { return separable(p, redGreen_, redGreen_); }

std::vector<float> FlipFilters::blueYellow(const FlipPlane& p) const {
    std::vector<float> sum = separable(p, wideYellow_, wideYellow_);
    const std::vector<float> narrow = separable(p, narrowYellow_, narrowYellow_);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += narrow[i];
    return sum;
}

std::vector<float> FlipFilters::edges(const FlipPlane& p) const { return features(p, edge_); }
std::vector<float> FlipFilters::points(const FlipPlane& p) const { return features(p, point_); }

} // namespace abbe
