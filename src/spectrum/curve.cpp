#include "spectrum/curve.h"

#include "base/check.h"

#include <algorithm>

namespace abbe {

namespace {

constexpr double kFirst = kMinWavelength;
constexpr double kLast = kMaxWavelength;

// Adds ∫ f(λ) hat_i(λ) dλ over [a, b] to the nodes at both ends of the 1 nm cell that holds [a, b], for f linear with
// values fa, fb. Simpson's rule is exact for the product of two linear functions.
void depositPiece(std::array<double, SampledCurve::kSize>& nodes, double a, double b, double fa, double fb) {
    const int cell = std::min(static_cast<int>(0.5 * (a + b) - kFirst), SampledCurve::kSize - 2);
    const double s = a - kFirst - cell, t = b - kFirst - cell; // position in the cell
    const double middle = 0.5 * (fa + fb);
    const double width = b - a;
    const double upper = width * (fa * s + 4 * middle * 0.5 * (s + t) + fb * t) / 6;
    const double all = width * middle;
    nodes[static_cast<std::size_t>(cell)] += all - upper;
    nodes[static_cast<std::size_t>(cell) + 1] += upper;
}

// One segment of the data, cut at whole nanometres and at the ends of the table.
void depositSegment(std::array<double, SampledCurve::kSize>& nodes, double nm0, double nm1, double f0, double f1) {
    const double begin = std::max(nm0, kFirst), end = std::min(nm1, kLast);
    if (!(begin < end)) return;
    const double slope = (f1 - f0) / (nm1 - nm0);
    double a = begin;
    while (a < end) {
        const double b = std::min(end, std::floor(a) + 1);
        depositPiece(nodes, a, b, f0 + slope * (a - nm0), f0 + slope * (b - nm0));
        a = b;
    }
}

double interpolate(std::span<const double> nm, std::span<const double> values, double x) {
    const auto next = std::upper_bound(nm.begin(), nm.end(), x);
    if (next == nm.begin()) return values.front();
    if (next == nm.end()) return values.back();
    const std::size_t i = static_cast<std::size_t>(next - nm.begin());
    return values[i - 1] + (values[i] - values[i - 1]) * ((x - nm[i - 1]) / (nm[i] - nm[i - 1]));
}

} // namespace

SampledCurve::SampledCurve(const std::array<double, kSize>& nodes) {
    for (std::size_t i = 0; i < kSize; ++i) table_[i] = static_cast<float>(nodes[i]);
    const auto [least, most] = std::minmax_element(table_.begin(), table_.end());
    minimum_ = *least;
    maximum_ = *most;
}

SampledCurve::SampledCurve(const std::function<double(double)>& f)
    : SampledCurve([&f] {
          std::array<double, kSize> nodes;
          for (std::size_t i = 0; i < kSize; ++i) nodes[i] = f(kFirst + static_cast<double>(i));
          return nodes;
      }()) {}

SampledCurve SampledCurve::fromPoints(std::span<const double> nm, std::span<const double> values) {
    ABBE_CHECK(!nm.empty() && nm.size() == values.size());
    return SampledCurve([&](double x) { return interpolate(nm, values, x); });
}

SampledCurve SampledCurve::fromEmissionPoints(std::span<const double> nm, std::span<const double> values) {
    ABBE_CHECK(nm.size() == values.size());
    std::array<double, kSize> nodes{};
    for (std::size_t i = 1; i < nm.size(); ++i) depositSegment(nodes, nm[i - 1], nm[i], values[i - 1], values[i]);
    // The hats of the two end nodes lie half outside the table.
    nodes.front() *= 2;
    nodes.back() *= 2;
    return SampledCurve(nodes);
}

double SampledCurve::at(double nanometres) const {
    const double x = std::clamp(nanometres, kFirst, kLast) - kFirst;
    const std::size_t cell = std::min<std::size_t>(static_cast<std::size_t>(x), kSize - 2);
    const double a = table_[cell], b = table_[cell + 1];
    return a + (b - a) * (x - static_cast<double>(cell));
}

} // namespace abbe
