#include "math/distribution.h"

#include "base/check.h"

namespace abbe {

double buildCumulative(std::span<const double> weights, std::span<double> cumulative) {
    ABBE_CHECK(!weights.empty() && cumulative.size() == weights.size() + 1);
    double total = 0;
    cumulative[0] = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        ABBE_CHECK(weights[i] >= 0 && std::isfinite(weights[i]));
        total += weights[i];
        cumulative[i + 1] = total;
    }
    ABBE_CHECK(std::isfinite(total));
    const double count = static_cast<double>(weights.size());
    // Dividing the total by itself gives exactly 1, also after trailing bins of weight 0.
    for (std::size_t i = 1; i < cumulative.size(); ++i)
        cumulative[i] = total > 0 ? cumulative[i] / total : static_cast<double>(i) / count;
    return total;
}

BinSample sampleCumulative(std::span<const double> cumulative, float u) noexcept {
    // The first entry above u ends a bin that is not empty, because the entry before it is not above u.
    const auto end = std::upper_bound(cumulative.begin() + 1, cumulative.end() - 1, static_cast<double>(u));
    const double upper = *end, lower = *(end - 1), width = upper - lower;
    ABBE_DCHECK(u >= 0 && u < 1 && width > 0);
    BinSample result;
    result.index = static_cast<std::uint32_t>(end - cumulative.begin() - 1);
    result.offset = std::min(static_cast<float>((u - lower) / width), kOneMinusEpsilon);
    result.probability = width;
    return result;
}

Distribution1D::Distribution1D(std::span<const double> weights)
    : cumulative_(weights.size() + 1), total_(buildCumulative(weights, cumulative_)) {}

std::uint32_t Distribution1D::pick(double u) const noexcept {
    ABBE_DCHECK(u >= 0 && u < 1);
    return static_cast<std::uint32_t>(std::upper_bound(cumulative_.begin() + 1, cumulative_.end() - 1, u) -
                                      cumulative_.begin() - 1);
}

std::size_t Distribution1D::bin(float x) const noexcept {
    const double scaled = std::max(0.0, static_cast<double>(x) * static_cast<double>(size()));
    return std::min(static_cast<std::size_t>(scaled), size() - 1);
}

Distribution1D::Point Distribution1D::samplePoint(float u) const noexcept {
    const BinSample s = sample(u);
    const double count = static_cast<double>(size());
    const float x = static_cast<float>((s.index + static_cast<double>(s.offset)) / count);
    return {std::min(x, kOneMinusEpsilon), static_cast<float>(s.probability * count)};
}

float Distribution1D::pdf(float x) const noexcept {
    return static_cast<float>(probability(bin(x)) * static_cast<double>(size()));
}

float Distribution1D::inverse(float x) const noexcept {
    const std::size_t b = bin(x);
    const double offset = static_cast<double>(x) * static_cast<double>(size()) - static_cast<double>(b);
    return std::min(static_cast<float>(cumulative_[b] + probability(b) * offset), kOneMinusEpsilon);
}

namespace {

// Fills the rows' cumulative probabilities and returns their sums.
std::vector<double> buildRows(std::span<const double> weights, std::size_t columns, std::vector<double>& conditional) {
    ABBE_CHECK(columns > 0 && !weights.empty() && weights.size() % columns == 0);
    const std::size_t rows = weights.size() / columns;
    conditional.resize(rows * (columns + 1));
    std::vector<double> sums(rows);
    for (std::size_t row = 0; row < rows; ++row)
        sums[row] = buildCumulative(weights.subspan(row * columns, columns),
                                    std::span(conditional).subspan(row * (columns + 1), columns + 1));
    return sums;
}

} // namespace

Distribution2D::Distribution2D(std::span<const double> weights, std::size_t columns)
    : columns_(columns), marginal_(buildRows(weights, columns, conditional_)) {}

CellSample Distribution2D::sample(Vec2 u) const noexcept {
    const BinSample row = marginal_.sample(u.y);
    const BinSample column = sampleCumulative(cumulative(row.index), u.x);
    return {column.index, row.index, {column.offset, row.offset}, row.probability * column.probability};
}

double Distribution2D::probability(std::size_t column, std::size_t row) const noexcept {
    const std::span<const double> c = cumulative(row);
    return marginal_.probability(row) * (c[column + 1] - c[column]);
}

} // namespace abbe
