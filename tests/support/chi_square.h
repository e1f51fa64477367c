// Pearson's χ² test of samplers against their densities.
#pragma once

#include "math/vec.h"
#include "support/nightly.h"
#include "support/quadrature.h"
#include "support/statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

namespace abbe::test {

struct ChiSquareResult {
    double statistic = 0;
    int degrees = 0;
    double pValue = 1;
};

// Observed counts against expected ones. Bins with fewer than `minimum` expected counts are merged, smallest first.
// A count where (nearly) none is expected fails outright: p = 0.
inline ChiSquareResult chiSquareTest(std::span<const double> observed, std::span<const double> expected,
                                     double minimum = 5) {
    std::vector<std::size_t> order(expected.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](auto a, auto b) { return expected[a] < expected[b]; });
    ChiSquareResult result;
    double pooledObserved = 0, pooledExpected = 0;
    int bins = 0;
    const auto close = [&] {
        const double d = pooledObserved - pooledExpected;
        result.statistic += d * d / pooledExpected;
        pooledObserved = pooledExpected = 0;
        ++bins;
    };
    for (const std::size_t i : order) {
        if (expected[i] <= 1e-9 && observed[i] > 0) return {kInfinity, 1, 0};
        pooledObserved += observed[i];
        pooledExpected += expected[i];
        if (pooledExpected >= minimum) close();
    }
    if (pooledExpected > 1e-9) close();
    result.degrees = bins - 1;
    if (result.degrees > 0) result.pValue = chiSquareUpper(result.statistic, result.degrees);
    return result;
}

// Number of samples of a χ² test.
inline int chiSquareSamples() { return nightly() ? 1000000 : 100000; }

// [lower, upper] cut into `count` cells that crowd around `centre`: equal steps of asinh((x - centre) / width), so that
// a sharp lobe is spread over many cells and smooth functions stay smooth within each.
class CrowdedCells {
  public:
    CrowdedCells(double lower, double upper, double centre, double width, int count)
        : centre_(centre), width_(width), a_(std::asinh((lower - centre) / width)),
          b_(std::asinh((upper - centre) / width)), count_(count) {}
    int count() const { return count_; }
    double at(double v) const { return centre_ + width_ * std::sinh(a_ + v * (b_ - a_)); } // v in [0, 1]
    double slope(double v) const { return width_ * (b_ - a_) * std::cosh(a_ + v * (b_ - a_)); }
    double inverse(double x) const { return (std::asinh((x - centre_) / width_) - a_) / (b_ - a_); }
    int cell(double x) const { return std::clamp(static_cast<int>(inverse(x) * count_), 0, count_ - 1); }

  private:
    double centre_, width_, a_, b_;
    int count_;
};

// Cells of a hemisphere (z > 0 or z < 0) in polar angle and azimuth, crowded around a direction. Discontinuities at
// the horizon fall on cell borders.
class HemisphereCells {
  public:
    // `width`: half the size of the lobe around `centre`, rad.
    HemisphereCells(bool upper, Vec3d centre, double width, int thetaCells = 24, int phiCells = 24)
        : sign_(upper ? 1 : -1), theta_(0, kPiD / 2, std::clamp(polar(centre), 0.0, kPiD / 2), width, thetaCells),
          phi0_(std::atan2(centre.y, centre.x)),
          phi_(-kPiD, kPiD, 0, width / std::max(std::sin(polar(centre)), width / kPiD), phiCells) {}

    int count() const { return theta_.count() * phi_.count(); }
    bool contains(Vec3d w) const { return w.z * sign_ > 0; }
    int cell(Vec3d w) const {
        const double phi = std::remainder(std::atan2(w.y, w.x) - phi0_, 2 * kPiD);
        return theta_.cell(polar(w)) * phi_.count() + phi_.cell(phi);
    }
    // The function to integrate jumps at this |cos θ|: cells there are integrated in two parts.
    HemisphereCells& jumpsAt(double cosine) {
        if (cosine > 0 && cosine < 1) jump_ = theta_.inverse(std::acos(cosine)) * theta_.count();
        return *this;
    }
    // ∫ f(w) dω over each cell.
    template <typename F> std::vector<double> integrals(F&& f) const {
        std::vector<double> result(static_cast<std::size_t>(count()), 0.0);
        for (int c = 0; c < count(); ++c) {
            const double v = c / phi_.count(), w = c % phi_.count(), split = std::clamp(jump_, v, v + 1);
            result[static_cast<std::size_t>(c)] = part(f, v, split, w) + part(f, split, v + 1, w);
        }
        return result;
    }
    template <typename F> double integral(F&& f) const {
        const auto cells = integrals(f);
        return std::accumulate(cells.begin(), cells.end(), 0.0);
    }

  private:
    // Angle from the pole of this hemisphere; exact near the pole, unlike acos.
    double polar(Vec3d w) const { return std::atan2(std::hypot(w.x, w.y), w.z * sign_); }
    // ∫ over [v0, v1] of the polar axis and [w, w + 1] of the azimuth, both counted in cells.
    template <typename F> double part(F& f, double v0, double v1, double w) const {
        static const GaussLegendre<8> rule;
        if (v0 == v1) return 0;
        double sum = 0;
        for (std::size_t i = 0; i < 8; ++i)
            for (std::size_t j = 0; j < 8; ++j) {
                const double v = (v0 + rule.node[i] * (v1 - v0)) / theta_.count();
                const double u = (w + rule.node[j]) / phi_.count();
                const double theta = theta_.at(v), phi = phi0_ + phi_.at(u), s = std::sin(theta);
                const Vec3d d{s * std::cos(phi), s * std::sin(phi), sign_ * std::cos(theta)};
                sum += rule.weight[i] * rule.weight[j] * f(d) * s * theta_.slope(v) * phi_.slope(u);
            }
        return sum * (v1 - v0) / count();
    }
    double jump_ = -1;
    double sign_;
    CrowdedCells theta_;
    double phi0_;
    CrowdedCells phi_;
};

// χ² of a sampler of directions on one hemisphere; everything else that it returns (other hemisphere, rejections)
// is one more cell. sample() -> optional<Vec3d>, pdf(Vec3d) -> density in solid angle.
template <typename Sample, typename Pdf>
ChiSquareResult chiSquareDirections(const HemisphereCells& cells, Sample&& sample, Pdf&& pdf, int samples) {
    std::vector<double> expected = cells.integrals(pdf);
    const double inside = std::accumulate(expected.begin(), expected.end(), 0.0);
    expected.push_back(std::max(1e-6, 1 - inside)); // at least the error of the quadrature
    for (double& e : expected) e *= samples;
    std::vector<double> observed(expected.size(), 0.0);
    for (int i = 0; i < samples; ++i) {
        const auto w = sample();
        const bool in = w && cells.contains(*w);
        ++observed[in ? static_cast<std::size_t>(cells.cell(*w)) : observed.size() - 1];
    }
    return chiSquareTest(observed, expected);
}

} // namespace abbe::test
