#include "media/angular_table.h"

#include "base/check.h"
#include "math/vec.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

// Cosines near ±1 are 6e-8 apart; a cell holds several of them.
constexpr double kNarrowest = 0x1p-22;

double area(std::span<const double> t, std::span<const double> values, std::size_t from, std::size_t to) {
    double sum = 0;
    for (std::size_t i = from; i < to; ++i) sum += 0.5 * (values[i] + values[i + 1]) * (t[i + 1] - t[i]);
    return sum;
}

} // namespace

AngularGrid::AngularGrid(std::span<const double> angles) {
    ABBE_CHECK(angles.size() >= 2);
    for (const double angle : angles) all_.push_back(2 * square(std::sin(angle / 2)));
    all_.front() = 0;
    all_.back() = 2;
    first_ = 1;
    last_ = all_.size() - 1;
    while (first_ < last_ && all_[first_] < kNarrowest) ++first_;
    while (last_ > first_ && 2 - all_[last_ - 1] < kNarrowest) --last_;
    nodes_.push_back(0);
    nodes_.insert(nodes_.end(), all_.begin() + static_cast<std::ptrdiff_t>(first_),
                  all_.begin() + static_cast<std::ptrdiff_t>(last_));
    nodes_.push_back(2);
}

std::vector<double> AngularGrid::atNodes(std::span<const double> values) const {
    std::vector<double> kept{values.front()};
    kept.insert(kept.end(), values.begin() + static_cast<std::ptrdiff_t>(first_),
                values.begin() + static_cast<std::ptrdiff_t>(last_));
    kept.push_back(values.back());
    const std::size_t n = kept.size(), end = all_.size() - 1;
    if (n == 2) { // all in one cell
        kept[0] = std::max(0.0, area(all_, values, 0, end) - kept[1]);
        return kept;
    }
    if (first_ > 1) kept[0] = std::max(0.0, 2 * area(all_, values, 0, first_) / nodes_[1] - kept[1]);
    if (last_ < end)
        kept[n - 1] = std::max(0.0, 2 * area(all_, values, last_ - 1, end) / (2 - nodes_[n - 2]) - kept[n - 2]);
    return kept;
}

double AngularGrid::integral(std::span<const double> atNodes) const {
    return 2 * kPiD * area(nodes_, atNodes, 0, nodes_.size() - 1);
}

double AngularGrid::firstMoment(std::span<const double> atNodes) const {
    double sum = 0;
    for (std::size_t i = 0; i + 1 < nodes_.size(); ++i) {
        const double a = 1 - nodes_[i], b = 1 - nodes_[i + 1]; // ∫ of a product of two linear functions
        sum += (nodes_[i + 1] - nodes_[i]) *
               (2 * a * atNodes[i] + a * atNodes[i + 1] + b * atNodes[i] + 2 * b * atNodes[i + 1]) / 6;
    }
    return 2 * kPiD * sum;
}

AngularTable::AngularTable(const AngularGrid& grid, std::span<const double> atNodes)
    : t_(grid.nodes().begin(), grid.nodes().end()) {
    ABBE_CHECK(atNodes.size() == t_.size());
    const double total = grid.integral(atNodes);
    ABBE_CHECK(total > 0);
    for (const double value : atNodes) values_.push_back(static_cast<float>(value / total));
    // The distribution of the rounded values: it is these that value() returns.
    cumulative_.push_back(0);
    for (std::size_t i = 0; i + 1 < t_.size(); ++i)
        cumulative_.push_back(cumulative_.back() +
                              0.5 * (double{values_[i]} + double{values_[i + 1]}) * (t_[i + 1] - t_[i]));
}

AngularTable::Place AngularTable::find(float cosine) const noexcept {
    const double t = std::clamp(1 - static_cast<double>(cosine), 0.0, 2.0);
    const auto above = std::upper_bound(t_.begin() + 1, t_.end() - 1, t);
    const auto cell = static_cast<std::size_t>(above - t_.begin()) - 1;
    return {static_cast<std::uint32_t>(cell), static_cast<float>((t - t_[cell]) / (t_[cell + 1] - t_[cell]))};
}

float AngularTable::value(Place place) const noexcept {
    return values_[place.cell] * (1 - place.fraction) + values_[place.cell + 1] * place.fraction;
}

float AngularTable::sampleCosine(float u) const noexcept {
    // u stands for an interval of 2^-24; its middle is never at an end, where the density may be 0.
    const double target = (static_cast<double>(u) + 0x1p-25) * cumulative_.back();
    const auto above = std::upper_bound(cumulative_.begin() + 1, cumulative_.end() - 1, target);
    const auto cell = static_cast<std::size_t>(above - cumulative_.begin()) - 1;
    const double width = t_[cell + 1] - t_[cell], mass = (target - cumulative_[cell]) / width;
    const auto a = static_cast<double>(values_[cell]), b = static_cast<double>(values_[cell + 1]);
    // Root of a s + (b - a) s²/2 = mass in the form that keeps its digits for all a and b.
    const double root = a + std::sqrt(std::max(0.0, a * a + 2 * (b - a) * mass));
    const double s = root > 0 ? std::min(1.0, 2 * mass / root) : 0.5;
    return static_cast<float>(std::clamp(1 - (t_[cell] + s * width), -1.0, 1.0));
}

} // namespace abbe
