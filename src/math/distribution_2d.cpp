#include "math/distribution_2d.h"

#include "base/check.h"

namespace abbe {

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
