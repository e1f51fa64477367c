#include "io/tile_test.h"

#include "base/check.h"
#include "math/student.h"
#include "math/vec.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <optional>
#include <vector>

namespace abbe {

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
