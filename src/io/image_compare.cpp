#include "io/image_compare.h"

#include "base/check.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <limits>

namespace abbe {

namespace {

constexpr double kReferenceMean = 0.25; // images are scaled so that the reference has it
constexpr double kEpsilon = 0.01;

double meanOf(const std::vector<float>& values) {
    double sum = 0;
    for (const float v : values) sum += v;
    return sum / static_cast<double>(values.size());
}

double scaleOf(double mean) { return mean > 0 ? kReferenceMean / mean : 1; }

// Mean over all pixels but the `tail` share that has the largest values.
double meanWithoutTail(std::vector<double> values, double tail) {
    const auto kept = static_cast<std::ptrdiff_t>(std::ceil(static_cast<double>(values.size()) * (1 - tail)));
    std::nth_element(values.begin(), values.begin() + std::min<std::ptrdiff_t>(kept, std::ssize(values) - 1),
                     values.end());
    double sum = 0;
    for (std::ptrdiff_t i = 0; i < kept; ++i) sum += values[static_cast<std::size_t>(i)];
    return sum / static_cast<double>(kept);
}

bool isFinitePixel(const RgbImage& image, std::size_t i) {
    return std::isfinite(image.rgb[i]) && std::isfinite(image.rgb[i + 1]) && std::isfinite(image.rgb[i + 2]);
}

} // namespace

std::optional<std::string> comparisonFault(const RgbImage& image, const RgbImage& reference) {
    if (image.width() != reference.width() || image.height() != reference.height())
        return fmt::format("the images differ in size: {} by {} and {} by {}", image.width(), image.height(),
                           reference.width(), reference.height());
    if (image.window.x0 != reference.window.x0 || image.window.y0 != reference.window.y0)
        return "the images are different parts of the picture (their data windows differ)";
    const auto &a = image.chromaticities, &b = reference.chromaticities;
    if (a && b && !a->matches(b->space()))
        return "the images are in different RGB spaces (their chromaticities differ)";
    return std::nullopt;
}

ImageDifference compare(const RgbImage& image, const RgbImage& reference) {
    ABBE_CHECK(!comparisonFault(image, reference) && !image.rgb.empty());
    ImageDifference d;
    const double referenceMean = meanOf(reference.rgb), scale = scaleOf(referenceMean);
    const auto components = static_cast<double>(image.rgb.size());
    std::vector<double> relative(image.rgb.size() / 3); // per pixel, mean of the three
    double squares = 0, peak = 0;
    for (std::size_t i = 0; i < image.rgb.size(); ++i) {
        const double r = reference.rgb[i], difference = image.rgb[i] - r;
        squares += square(difference);
        d.maximum = std::max(d.maximum, std::abs(difference));
        peak = std::max(peak, r);
        relative[i / 3] += square(difference * scale) / (square(r * scale) + kEpsilon) / 3;
    }
    for (std::size_t i = 0; i < image.rgb.size(); i += 3)
        d.nonFinite += !(isFinitePixel(image, i) && isFinitePixel(reference, i));
    if (d.nonFinite > 0) {
        const double nan = std::numeric_limits<double>::quiet_NaN();
        d.mse = d.relMse = d.relMseWithoutTail = d.psnr = d.maximum = d.meanRatio = nan;
        return d;
    }
    d.mse = squares / components;
    for (const double v : relative) d.relMse += v / static_cast<double>(relative.size());
    d.relMseWithoutTail = meanWithoutTail(std::move(relative), 0.001);
    d.psnr = d.mse == 0 ? std::numeric_limits<double>::infinity() : 10 * std::log10(square(peak) / d.mse);
    d.meanRatio = meanOf(image.rgb) / referenceMean;
    return d;
}

double unbiasedRelMse(const RgbImage& image, const RgbImage& a, const RgbImage& b) {
    ABBE_CHECK(image.rgb.size() == a.rgb.size() && a.rgb.size() == b.rgb.size() && !a.rgb.empty());
    const double scale = scaleOf((meanOf(a.rgb) + meanOf(b.rgb)) / 2);
    double sum = 0;
    for (std::size_t i = 0; i < image.rgb.size(); ++i) {
        const double x = image.rgb[i] * scale, ra = a.rgb[i] * scale, rb = b.rgb[i] * scale;
        sum += (x - ra) * (x - rb) / (square((ra + rb) / 2) + kEpsilon);
    }
    return sum / static_cast<double>(image.rgb.size());
}

} // namespace abbe
