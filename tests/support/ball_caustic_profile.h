// The irradiance of ball_caustic.h as a function of the distance from the axis, interpolated, and its means over
// pixels.
#pragma once

#include "support/ball_caustic.h"

#include <vector>

namespace abbe::test {

class BallCausticProfile {
  public:
    // From the axis to `far`. Pieces of degree 4 are halved until three places between their nodes are met to
    // `tolerance`, relative; where there is a step, until what it spoils of a mean over `resolution` is as little.
    BallCausticProfile(const BallCaustic& caustic, double far, double resolution, double tolerance = 1e-4)
        : caustic_(caustic), resolution_(resolution), tolerance_(tolerance) {
        for (int i = 0; i < kFirst; ++i) add(far * i / kFirst, far * (i + 1) / kFirst, 14);
    }

    // Requires 0 <= rho <= far.
    double at(double rho) const {
        const auto next = std::upper_bound(pieces_.begin(), pieces_.end(), rho,
                                           [](double value, const Piece& p) { return value < p.from; });
        return value(*(next - 1), rho);
    }

    // Over x0 <= x <= x1, z0 <= z <= z1 of the floor: `cells` by `cells` rules of eight points each way.
    double mean(double x0, double x1, double z0, double z1, int cells = 12) const {
        return integrate2([&](double x, double z) { return at(std::hypot(x, z)); }, x0, x1, z0, z1, cells, cells) /
               ((x1 - x0) * (z1 - z0));
    }

    std::size_t pieces() const { return pieces_.size(); }

  private:
    static constexpr int kFirst = 16;
    struct Piece {
        double from, to;
        std::array<double, 5> value; // at Chebyshev's points of the first kind
    };
    static double angle(std::size_t k) { return static_cast<double>(2 * k + 1) * std::numbers::pi / 10; }
    static double node(std::size_t k) { return (1 - std::cos(angle(k))) / 2; }

    void add(double from, double to, int depth) {
        Piece p{from, to, {}};
        for (std::size_t k = 0; k < 5; ++k) p.value[k] = caustic_.irradiance(from + (to - from) * node(k));
        const double share = std::min(1.0, (to - from) / resolution_);
        const bool good = depth == 0 || (met(p, 0.07, share) && met(p, 0.31, share) && met(p, 0.79, share));
        if (good) {
            pieces_.push_back(p);
            return;
        }
        add(from, (from + to) / 2, depth - 1);
        add((from + to) / 2, to, depth - 1);
    }
    bool met(const Piece& p, double t, double share) const {
        const double rho = p.from + (p.to - p.from) * t, exact = caustic_.irradiance(rho);
        return std::abs(value(p, rho) - exact) * share <= tolerance_ * exact;
    }

    // Barycentric [Berrut2004, eq. 4.2, 5.2].
    static double value(const Piece& p, double rho) {
        const double t = (rho - p.from) / (p.to - p.from);
        double above = 0, below = 0;
        for (std::size_t k = 0; k < 5; ++k) {
            const double d = t - node(k);
            if (d == 0) return p.value[k];
            const double w = (k % 2 ? -1 : 1) * std::sin(angle(k)) / d;
            above += w * p.value[k];
            below += w;
        }
        return above / below;
    }

    BallCaustic caustic_;
    double resolution_, tolerance_;
    std::vector<Piece> pieces_;
};

} // namespace abbe::test
