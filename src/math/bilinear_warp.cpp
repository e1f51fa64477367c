#include "math/bilinear_warp.h"

#include "base/check.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

double between(double a, double b, double t) { return a + (b - a) * t; }

// ∫₀ᵗ of what goes from a to b over a unit.
double upTo(double a, double b, double t) { return t * (a + 0.5 * (b - a) * t); }

// The t in [0, 1] with upTo(a, b, t) = area. The form without a difference of nearly equal numbers.
double reaching(double a, double b, double area) {
    const double root = a + std::sqrt(std::max(0.0, a * a + 2 * (b - a) * area));
    return root > 0 ? std::min(2 * area / root, 1.0) : 0;
}

// The last of n + 1 sums, which begin with 0, that is not above `aim`; below n.
template <typename SumAt> std::size_t cellBelow(std::size_t n, double aim, const SumAt& sumAt) {
    std::size_t low = 0, high = n;
    while (high - low > 1) {
        const std::size_t middle = (low + high) / 2;
        (sumAt(middle) <= aim ? low : high) = middle;
    }
    return low;
}

} // namespace

AxisPlace placeOnAxis(std::span<const float> values, double x) noexcept {
    if (values.size() < 2 || !(x > values.front())) return {};
    if (x >= values.back()) return {values.size() - 2, 1};
    const auto above = std::upper_bound(values.begin(), values.end(), x);
    const auto index = static_cast<std::size_t>(above - values.begin()) - 1;
    return {index, (x - values[index]) / (values[index + 1] - values[index])};
}

TableBlend blendTables(AxisPlace first, AxisPlace second, std::size_t seconds) noexcept {
    TableBlend b;
    for (const std::size_t i : {0u, 1u})
        for (const std::size_t j : {0u, 1u}) {
            const double weight =
                (i ? first.fraction : 1 - first.fraction) * (j ? second.fraction : 1 - second.fraction);
            if (!(weight > 0)) continue;
            b.table[static_cast<std::size_t>(b.count)] = (first.index + i) * seconds + second.index + j;
            b.weight[static_cast<std::size_t>(b.count++)] = weight;
        }
    return b;
}

BilinearCell::BilinearCell(Vec2d at, std::size_t rows, std::size_t columns) noexcept {
    const double x = std::clamp(at.x, 0.0, 1.0) * static_cast<double>(columns - 1),
                 y = std::clamp(at.y, 0.0, 1.0) * static_cast<double>(rows - 1);
    column = std::min(static_cast<std::size_t>(x), columns - 2);
    row = std::min(static_cast<std::size_t>(y), rows - 2);
    across = x - static_cast<double>(column);
    down = y - static_cast<double>(row);
}

BilinearWarp::BilinearWarp(std::vector<float> values, std::size_t rows, std::size_t columns)
    : rows_(rows), columns_(columns), values_(std::move(values)), rowSums_(values_.size()) {
    ABBE_CHECK(rows > 1 && columns > 1 && values_.size() % (rows * columns) == 0);
    const std::size_t tables = values_.size() / (rows * columns);
    const double width = 1 / static_cast<double>(columns - 1), height = 1 / static_cast<double>(rows - 1);
    std::vector<double> rowSums(rows * columns), sums(rows);
    for (std::size_t table = 0; table < tables; ++table) {
        float* v = values_.data() + table * rows * columns;
        for (std::size_t r = 0; r < rows; ++r) {
            rowSums[r * columns] = 0;
            for (std::size_t c = 1, i = r * columns + 1; c < columns; ++c, ++i)
                rowSums[i] = rowSums[i - 1] + 0.5 * width * (double(v[i - 1]) + double(v[i]));
            const auto total = [&](std::size_t row) { return rowSums[(row + 1) * columns - 1]; };
            sums[r] = r == 0 ? 0 : sums[r - 1] + 0.5 * height * (total(r - 1) + total(r));
        }
        const double all = sums.back();
        ABBE_CHECK(all > 0 && std::isfinite(all));
        for (std::size_t i = 0; i < rows * columns; ++i) {
            v[i] = static_cast<float>(v[i] / all);
            rowSums_[table * rows * columns + i] = static_cast<float>(rowSums[i] / all);
        }
        for (const double s : sums) sums_.push_back(static_cast<float>(s / all));
    }
}

double BilinearWarp::blend(const std::vector<float>& of, std::size_t stride, std::size_t at,
                           const TableBlend& b) const noexcept {
    double sum = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(b.count); ++i)
        sum += b.weight[i] * double(of[b.table[i] * stride + at]);
    return sum;
}

BilinearWarp::Point BilinearWarp::sample(const TableBlend& b, Vec2d uniform) const noexcept {
    const double width = static_cast<double>(columns_ - 1), height = static_cast<double>(rows_ - 1);
    const std::size_t r = cellBelow(rows_ - 1, uniform.y, [&](std::size_t row) { return rowsUpTo(row, b); });
    const double above = rowTotal(r, b), below = rowTotal(r + 1, b);
    const double t = reaching(above, below, std::max(0.0, uniform.y - rowsUpTo(r, b)) * height);
    const auto inRow = [&](std::size_t c) { return between(rowUpTo(r, c, b), rowUpTo(r + 1, c, b), t); };
    const double aim = uniform.x * between(above, below, t);
    const std::size_t c = cellBelow(columns_ - 1, aim, inRow);
    const double left = between(value(r, c, b), value(r + 1, c, b), t),
                 right = between(value(r, c + 1, b), value(r + 1, c + 1, b), t);
    const double s = reaching(left, right, std::max(0.0, aim - inRow(c)) * width);
    return {{(static_cast<double>(c) + s) / width, (static_cast<double>(r) + t) / height}, between(left, right, s)};
}

BilinearWarp::Point BilinearWarp::invert(const TableBlend& b, Vec2d at) const noexcept {
    const double width = static_cast<double>(columns_ - 1), height = static_cast<double>(rows_ - 1);
    const BilinearCell p(at, rows_, columns_);
    const std::size_t r = p.row, c = p.column;
    const double above = rowTotal(r, b), below = rowTotal(r + 1, b);
    const double left = between(value(r, c, b), value(r + 1, c, b), p.down),
                 right = between(value(r, c + 1, b), value(r + 1, c + 1, b), p.down);
    const double y = rowsUpTo(r, b) + upTo(above, below, p.down) / height, row = between(above, below, p.down),
                 x = between(rowUpTo(r, c, b), rowUpTo(r + 1, c, b), p.down) + upTo(left, right, p.across) / width;
    return {{row > 0 ? std::min(x / row, 1.0) : 0, std::min(y, 1.0)}, between(left, right, p.across)};
}

double BilinearWarp::density(const TableBlend& b, Vec2d at) const noexcept {
    const BilinearCell p(at, rows_, columns_);
    const double left = between(value(p.row, p.column, b), value(p.row + 1, p.column, b), p.down),
                 right = between(value(p.row, p.column + 1, b), value(p.row + 1, p.column + 1, b), p.down);
    return between(left, right, p.across);
}

} // namespace abbe
