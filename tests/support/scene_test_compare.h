// Statistical comparison of images with error bars.
#pragma once

#include "support/scene_test_film.h"

#include <doctest/doctest.h>
#include <functional>
#include <string>

namespace abbe::test {

// Probability of an error of the first kind of each check below. All seeds are fixed: a test fails always or never.
inline constexpr double kImageLevel = 1e-4;
// Relative differences that rounding in single precision explains; added to every error bar.
inline constexpr double kRounding = 1e-5;

// Student's t of one tile, as the probability of a smaller one: uniform on [0, 1] if the means are equal.
struct TileTest {
    double lower = 0.5;
    bool exact = false; // no spread and no difference
};
inline TileTest tileTest(Estimate a, Estimate b) {
    const double floor = square(kRounding * b.mean), variance = a.variance + b.variance;
    const double degrees = variance > 0 ? square(variance) / (square(a.variance) / a.degrees +
                                                              (b.variance > 0 ? square(b.variance) / b.degrees : 0))
                                        : 1;
    const double difference = a.mean - b.mean;
    if (std::abs(difference) <= kRounding * std::abs(b.mean)) return {0.5, variance <= floor};
    if (variance + floor == 0) return {difference < 0 ? 0.0 : 1.0, false};
    const double p = studentTwoSided(difference / std::sqrt(variance + floor), degrees);
    return {difference < 0 ? p / 2 : 1 - p / 2, false};
}

// Three views of whether two images are the same: the mean of all, the worst tile, and the distribution of the tiles'
// deviations, which sees many small ones.
struct ImageComparison {
    double wholeP = 1;      // two-sided, of the mean of the image
    double worstTileP = 1;  // two-sided, smallest over the tiles, not corrected for their number
    double kolmogorovP = 1; // that the tiles' deviations follow their distribution
    int tiles = 0;
    double difference = 0, error = 0; // of the image's mean, relative

    bool same(double level = kImageLevel) const {
        return wholeP > level && worstTileP > sidak(level, std::max(1, tiles)) && kolmogorovP > level;
    }
    std::string text() const {
        return "difference " + std::to_string(100 * difference) + " % ± " + std::to_string(100 * error) +
               " %, p of the mean " + std::to_string(wholeP) + ", of the worst of " + std::to_string(tiles) +
               " tiles " + std::to_string(worstTileP) + ", of their distribution " + std::to_string(kolmogorovP);
    }
};

// `a` and `b` estimate any rectangle of the image.
template <typename A, typename B> ImageComparison compareTiles(PixelBounds bounds, int tileSize, A&& a, B&& b) {
    ImageComparison result;
    const Estimate wholeA = a(bounds), wholeB = b(bounds);
    const auto twoSided = [](TileTest t) { return 2 * std::min(t.lower, 1 - t.lower); };
    result.wholeP = twoSided(tileTest(wholeA, wholeB));
    result.difference = wholeA.mean / wholeB.mean - 1;
    result.error = std::sqrt(wholeA.variance + wholeB.variance) / std::abs(wholeB.mean);
    std::vector<double> deviations;
    for (int y = bounds.y0; y < bounds.y1; y += tileSize)
        for (int x = bounds.x0; x < bounds.x1; x += tileSize) {
            const PixelBounds tile{x, y, std::min(x + tileSize, bounds.x1), std::min(y + tileSize, bounds.y1)};
            const TileTest t = tileTest(a(tile), b(tile));
            ++result.tiles;
            if (t.exact) continue;
            deviations.push_back(t.lower);
            result.worstTileP = std::min(result.worstTileP, twoSided(t));
        }
    if (deviations.size() >= 4) result.kolmogorovP = kolmogorovUniform(deviations);
    return result;
}

inline ImageComparison compareImages(const RecordingFilm& a, const RecordingFilm& b, Channel channel = Channel::y,
                                     int tileSize = 8) {
    return compareTiles(
        a.bounds(), tileSize, [&](PixelBounds t) { return a.tile(t, channel); },
        [&](PixelBounds t) { return b.tile(t, channel); });
}

// Against the exact value of every pixel.
inline ImageComparison compareExpected(const RecordingFilm& film, const std::function<double(int x, int y)>& expected,
                                       Channel channel = Channel::y, int tileSize = 8) {
    return compareTiles(
        film.bounds(), tileSize, [&](PixelBounds t) { return film.tile(t, channel); },
        [&](PixelBounds t) {
            double sum = 0;
            for (int y = t.y0; y < t.y1; ++y)
                for (int x = t.x0; x < t.x1; ++x) sum += expected(x, y);
            return Estimate{sum / static_cast<double>(t.area()), 0, 1};
        });
}

// `resolution`: largest relative standard error of the image's mean with which the test still says something.
inline void checkSame(const ImageComparison& c, double resolution = 0.0025) {
    INFO(c.text());
    CHECK(c.same());
    CHECK(c.error < resolution);
}

} // namespace abbe::test
