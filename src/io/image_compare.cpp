#include "io/image_compare.h"

#include "base/check.h"
#include "io/image.h"
#include "math/student.h"
#include "math/vec.h"
#include "spectrum/color_space.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

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

namespace {

constexpr double kMeanLuminance = 0.18;
constexpr int kTile = 8;

// Turns the RGB of an image into Lab.
class Viewing {
  public:
    Viewing(const RgbImage& image, const RgbImage& reference)
        : toXyz_(rgb::rec709.toXyz() * toDisplayRgb(image, reference)) {
        double sum = 0;
        for (std::size_t i = 0; i < reference.rgb.size(); i += 3) sum += xyz(&reference.rgb[i]).y;
        const double mean = sum / (static_cast<double>(reference.rgb.size()) / 3);
        if (mean > 0) scale_ = kMeanLuminance / mean;
    }

    Xyz xyz(const float* rgb) const { return toXyz_.apply<Xyz>(Vec3d{rgb[0], rgb[1], rgb[2]}) * scale_; }
    Lab lab(const Xyz& color) const {
        if (color.y <= 0) return {};
        return toLab(color.y > 1 ? color * (1 / color.y) : color, white_);
    }

  private:
    Matrix3 toXyz_;
    Xyz white_ = whiteXyz(rgb::rec709.white);
    double scale_ = 1;
};

// Calls back with the half-open pixel rectangle of every tile; those at the right and below may be smaller.
template <typename Function> void forTiles(int width, int height, Function&& function) {
    for (int y = 0; y < height; y += kTile)
        for (int x = 0; x < width; x += kTile)
            function(PixelWindow{x, y, std::min(x + kTile, width), std::min(y + kTile, height)});
}

Xyz tileMean(const Viewing& viewing, const RgbImage& image, const PixelWindow& tile) {
    Xyz sum;
    for (int y = tile.y0; y < tile.y1; ++y)
        for (int x = tile.x0; x < tile.x1; ++x)
            sum += viewing.xyz(&image.rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width()) +
                                               static_cast<std::size_t>(x))]);
    return sum * (1 / static_cast<double>(tile.area()));
}

struct Summary {
    double mean = 0, percentile95 = 0;
};
Summary summarise(std::vector<float> values) {
    Summary s;
    for (const float v : values) s.mean += v;
    s.mean /= static_cast<double>(values.size());
    const auto at = static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(values.size() - 1) + 0.5);
    std::nth_element(values.begin(), values.begin() + at, values.end());
    s.percentile95 = values[static_cast<std::size_t>(at)];
    return s;
}

} // namespace

ColorDifference colorDifference(const RgbImage& image, const RgbImage& reference) {
    ABBE_CHECK(image.rgb.size() == reference.rgb.size() && !image.rgb.empty());
    const Viewing viewing(image, reference);
    std::vector<float> pixels(image.rgb.size() / 3), tiles;
    for (std::size_t i = 0; i < pixels.size(); ++i)
        pixels[i] = static_cast<float>(
            deltaE2000(viewing.lab(viewing.xyz(&image.rgb[3 * i])), viewing.lab(viewing.xyz(&reference.rgb[3 * i]))));
    forTiles(image.width(), image.height(), [&](const PixelWindow& tile) {
        tiles.push_back(static_cast<float>(
            deltaE2000(viewing.lab(tileMean(viewing, image, tile)), viewing.lab(tileMean(viewing, reference, tile)))));
    });
    const Summary ofPixels = summarise(std::move(pixels)), ofTiles = summarise(std::move(tiles));
    return {ofPixels.mean, ofPixels.percentile95, ofTiles.mean, ofTiles.percentile95};
}

namespace {

constexpr int kTestTile = 8;
constexpr double kLevel = 0.01;

double normalBelow(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

// The probability that n numbers of the distribution are this far from it or farther [Stephens1970].
double kolmogorovProbability(double distance, double n) {
    const double l = (std::sqrt(n) + 0.12 + 0.11 / std::sqrt(n)) * distance;
    if (l < 0.2) return 1; // where the series converges slowly, and to 1
    double sum = 0;
    for (int j = 1; j <= 100; ++j) sum += (j % 2 ? 2 : -2) * std::exp(-2 * square(j * l));
    return std::clamp(sum, 0.0, 1.0);
}

// Sums of one image over a tile.
struct TileSums {
    double value = 0, variance = 0, squaredVariance = 0;

    void add(const NoisyPlane& p, std::size_t i) {
        value += p.values[i];
        variance += p.variances[i];
        squaredVariance += square(static_cast<double>(p.variances[i]));
    }
    bool finite() const { return std::isfinite(value) && std::isfinite(variance); }
};

struct TileScore {
    TileSums a, b;
    double rounding = 0; // of the sums

    explicit TileScore(const TileSums& sa, const TileSums& sb, const NoisyPlane& pa, const NoisyPlane& pb)
        : a(sa), b(sb), rounding(std::max(std::abs(sa.value) * pa.rounding, std::abs(sb.value) * pb.rounding)) {}

    bool noiseless() const { return a.variance + b.variance <= square(rounding); }
    bool equal() const { return std::abs(a.value - b.value) <= 4 * rounding; }
    // The degrees of freedom are Satterthwaite's, with the fourth powers of the deviations estimated by the squares of
    // the variances: E v² = σ⁴ (R + 1)/(R − 1) [Satterthwaite1946].
    double score(int replicatesA, int replicatesB) const {
        const double variance = a.variance + b.variance;
        const double freedom =
            square(variance) / (a.squaredVariance / (replicatesA + 1) + b.squaredVariance / (replicatesB + 1));
        return studentScore((a.value - b.value) / std::sqrt(variance), freedom);
    }
};

void summarise(TileTest& test, std::vector<double>& scores) {
    if (scores.empty()) return;
    const auto n = static_cast<double>(scores.size());
    double squares = 0;
    for (const double z : scores) test.mean += z / n;
    for (const double z : scores) squares += square(z - test.mean);
    test.deviation = std::sqrt(squares / std::max(1.0, n - 1));
    std::sort(scores.begin(), scores.end());
    for (std::size_t i = 0; i < scores.size(); ++i) {
        const double below = normalBelow(scores[i]), at = static_cast<double>(i);
        test.kolmogorov = std::max({test.kolmogorov, (at + 1) / n - below, below - at / n});
    }
    test.kolmogorovProbability = kolmogorovProbability(test.kolmogorov, n);
    test.largestProbability = std::min(1.0, n * 2 * normalBelow(-std::abs(test.largest)));
}

} // namespace

double TileTest::probability() const { return unequal > 0 ? 0 : std::min(kolmogorovProbability, largestProbability); }

std::string TileTest::verdict() const {
    if (tiles + noiseless == 0) return "nothing can be said: no tile has finite values and variances";
    if (unequal > 0) return fmt::format("the images differ: {} tiles without noise are not equal", unequal);
    if (tiles == 0) return "the images are equal; there is no noise";
    if (largest == 0) return "the images are equal, noise included";
    // Under N(0, 1) the mean of the scores has a standard error of 1/√n.
    std::string all;
    if (std::abs(mean) * std::sqrt(static_cast<double>(tiles)) > 4)
        all = fmt::format("on average the first is {}, by {:.2g} standard errors of a tile",
                          mean > 0 ? "brighter" : "darker", std::abs(mean));
    if (largestProbability < kLevel)
        return fmt::format("the images differ: z = {:.1f} in the tile at ({}, {}){}{}", largest, largestX, largestY,
                           all.empty() ? "" : "; ", all);
    if (kolmogorovProbability >= kLevel) return "the images agree within their noise";
    if (!all.empty()) return "the images differ: " + all;
    return fmt::format("the images do not differ as their variances say: the scores have a deviation of {:.2f} instead "
                       "of 1 (unusual noise, or seeds in common)",
                       deviation);
}

TileTest tileTest(const NoisyPlane& a, const NoisyPlane& b, int width, int height) {
    const std::size_t size = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    ABBE_CHECK(size > 0 && a.values.size() == size && a.variances.size() == size && b.values.size() == size &&
               b.variances.size() == size && a.replicates >= 2 && b.replicates >= 2);
    TileTest test;
    std::vector<double> scores;
    for (int y = 0; y < height; y += kTestTile)
        for (int x = 0; x < width; x += kTestTile) {
            TileSums sumsA, sumsB;
            for (int v = y; v < std::min(y + kTestTile, height); ++v)
                for (int u = x; u < std::min(x + kTestTile, width); ++u) {
                    const std::size_t i =
                        static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u);
                    sumsA.add(a, i);
                    sumsB.add(b, i);
                }
            if (!sumsA.finite() || !sumsB.finite()) {
                ++test.skipped;
                continue;
            }
            const TileScore tile(sumsA, sumsB, a, b);
            if (tile.noiseless()) {
                ++test.noiseless;
                test.unequal += !tile.equal();
                continue;
            }
            scores.push_back(tile.score(a.replicates, b.replicates));
            if (std::abs(scores.back()) > std::abs(test.largest)) {
                test.largest = scores.back();
                test.largestX = x;
                test.largestY = y;
            }
        }
    test.tiles = scores.size();
    summarise(test, scores);
    return test;
}

} // namespace abbe
