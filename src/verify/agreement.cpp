#include "verify/agreement.h"

#include "math/student.h"
#include "math/vec.h"
#include "verify/tile_sums.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace abbe {

namespace {

constexpr int kChannels = 3;
// Relative differences that single precision explains: the two evaluate the same light by other operations.
constexpr double kRounding = 1e-5;
// A replicate's part in the variance beyond which nobody can tell what the variance is. With 32 normal replicates it is
// hardly ever above a third.
constexpr double kMostOfVariance = 0.5;

BlockTest test(const BlockSums& blockA, const BlockSums& blockB, PixelBounds bounds, int channel) {
    const auto c = static_cast<std::size_t>(channel);
    const ReplicateMean a(blockA, c), b(blockB, c);
    BlockTest t;
    t.bounds = bounds;
    t.channel = channel;
    const double scale = std::max(std::abs(a.value), std::abs(b.value)), floor = square(kRounding * scale);
    const double variance = a.variance + b.variance, difference = b.value - a.value;
    if (scale > 0) {
        t.difference = difference / (a.value != 0 ? std::abs(a.value) : scale);
        t.error = std::sqrt(variance) / (a.value != 0 ? std::abs(a.value) : scale);
    }
    if (variance <= floor && std::abs(difference) <= 4 * kRounding * scale) {
        t.exact = true;
        return t;
    }
    t.judged = (a.variance <= floor || a.largestPart <= kMostOfVariance) &&
               (b.variance <= floor || b.largestPart <= kMostOfVariance);
    if (variance > 0) t.freedom = square(variance) / (square(a.variance) / a.freedom + square(b.variance) / b.freedom);
    t.score = studentScore(difference / std::sqrt(variance + floor), t.freedom);
    return t;
}

// The channel that is farthest apart; one that nobody can judge speaks for all.
BlockTest farthest(const BlockSums& a, const BlockSums& b, PixelBounds bounds) {
    std::optional<BlockTest> worst;
    for (int c = 0; c < kChannels; ++c) {
        const BlockTest t = test(a, b, bounds, c);
        if (!t.judged) return t;
        if (!worst || (worst->exact && !t.exact) || (!t.exact && std::abs(t.score) > std::abs(worst->score))) worst = t;
    }
    return *worst;
}

// Of the worst of n scores, by chance.
double bonferroni(double score, double n) { return std::min(1.0, normalTwoSided(score) * n); }

bool within(PixelBounds inner, PixelBounds outer) {
    return inner.x0 >= outer.x0 && inner.y0 >= outer.y0 && inner.x1 <= outer.x1 && inner.y1 <= outer.y1;
}

} // namespace

Agreement compare(const TileSums& a, const TileSums& b, double level) {
    Agreement result;
    result.level = level;
    result.tiles = a.columns() * a.rows();
    TileSums x = a, y = b;
    for (bool finest = true; x.columns() * x.rows() > 1; finest = false, x = x.coarser(), y = y.coarser())
        for (int row = 0; row < x.rows(); ++row)
            for (int column = 0; column < x.columns(); ++column) {
                const BlockTest t = farthest(x.at(column, row), y.at(column, row), x.bounds(column, row));
                result.unjudged += finest && !t.judged;
                if (t.judged && !t.exact) result.blocks.push_back(t);
            }
    result.whole = farthest(x.at(0, 0), y.at(0, 0), x.bounds(0, 0));
    std::stable_sort(result.blocks.begin(), result.blocks.end(),
                     [](const auto& s, const auto& t) { return std::abs(s.score) > std::abs(t.score); });
    double least = 1;
    if (result.whole.judged && !result.whole.exact) least = bonferroni(result.whole.score, kChannels);
    if (!result.blocks.empty())
        least =
            std::min(least, bonferroni(result.blocks[0].score, kChannels * static_cast<double>(result.blocks.size())));
    result.probability = std::min(1.0, 2 * least); // two families of tests
    return result;
}

double Agreement::detectable() const {
    constexpr double kPower = 2.326; // normal quantile of 99 %
    return whole.error * (studentOfScore(scoreOfTwoSided(level / 2 / kChannels), whole.freedom) + kPower);
}

std::vector<BlockTest> Agreement::worstBlocks(std::size_t most) const {
    std::vector<BlockTest> found;
    const double n = kChannels * static_cast<double>(blocks.size());
    for (const BlockTest& t : blocks) {
        if (found.size() == most || 2 * bonferroni(t.score, n) > level) break;
        if (std::none_of(found.begin(), found.end(),
                         [&](const BlockTest& f) { return within(t.bounds, f.bounds) || within(f.bounds, t.bounds); }))
            found.push_back(t);
    }
    return found;
}

} // namespace abbe
