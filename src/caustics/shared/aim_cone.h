// The directions from a point to a ball that paths of light are aimed at, and which part of them brings light.
#pragma once

#include "math/distribution.h"
#include "math/frame.h"
#include "math/vec.h"
#include "math/warp.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

namespace abbe {

// A ball about something that focuses light, for all the time that the shutter is open. Render space, m. From far away
// one that is larger than the scene's counts as that.
struct AimTarget {
    Vec3 centre;
    float radius = 0; // > 0
};

// The directions to a target. Even over them, in double: a target may be millions of its radii away
// (docs/hard_cases.md, case 30).
class AimCone {
  public:
    // Nothing from inside of the ball. Directions are floats: the cone is wider than the ball by a few of their steps,
    // so that rounding takes no ray past it and the density of a ball that is all but a point stays finite. Nothing for
    // one that is too wide to be of use, too: from a density of `least` on, 1/sr.
    static std::optional<AimCone> seen(const AimTarget& target, Vec3 from, double least = 0) {
        const Vec3d d = Vec3d(target.centre) - Vec3d(from);
        const double d2 = lengthSquared(d), distance = std::sqrt(d2);
        const double sine = static_cast<double>(target.radius) / distance + kSteps;
        if (!(sine < 1)) return std::nullopt; // and at its centre, where it is infinite
        const AimCone cone(d / distance, sine * sine);
        return cone.pdf() > least ? std::optional(cone) : std::nullopt;
    }

    // True only if there is a cone and w lies outside of it: a quick answer for most of many targets, by a bound on the
    // distance of the line from the ball's middle instead of roots.
    static bool passes(const AimTarget& target, Vec3 from, Vec3 w, double least = 0) {
        const Vec3d d = Vec3d(target.centre) - Vec3d(from);
        const double sum = std::abs(d.x) + std::abs(d.y) + std::abs(d.z); // >= its length
        const double wide = abbe::square(static_cast<double>(target.radius) + 1.001 * kSteps * sum);
        if (!(lengthSquared(cross(d, Vec3d(w))) > wide)) return false;
        const double d2 = lengthSquared(d); // the density is at least 1 / (2π sin² θ), as 1 - cos θ <= sin² θ
        return d2 > 1.00001 * wide && d2 > 1.00001 * 2 * kPiD * wide * least;
    }

    // The square is folded to a disk, and that to the cap by Lambert's projection: both keep areas.
    Vec3 sample(Vec2 u) const {
        const Vec2 p = squareToDisk(u);
        const double x = static_cast<double>(p.x), y = static_cast<double>(p.y);
        const double h = (x * x + y * y) * oneMinusCos_; // 1 - cos θ
        const double scale = safeSqrt(oneMinusCos_ * (2 - h));
        const Frame frame = Frame::fromNormal(Vec3(axis_));
        return Vec3(normalize(axis_ * (1 - h) + Vec3d(frame.x) * (x * scale) + Vec3d(frame.y) * (y * scale)));
    }
    // The u of sample(), of a direction within the cone; means little unless resolves().
    Vec2 square(Vec3 w) const {
        const Frame frame = Frame::fromNormal(Vec3(axis_));
        const double scale = 1 / std::sqrt(oneMinusCos_ * (1 + dot(axis_, Vec3d(w))));
        return diskToSquare({static_cast<float>(dot(Vec3d(frame.x), Vec3d(w)) * scale),
                             static_cast<float>(dot(Vec3d(frame.y), Vec3d(w)) * scale)});
    }
    // Whether directions, which are floats, tell parts of it apart.
    bool resolves() const { return sin2_ > 0x1p-24; }
    bool contains(Vec3 w) const {
        const Vec3d v(w);
        return dot(axis_, v) > 0 && lengthSquared(cross(axis_, v)) <= sin2_;
    }
    double pdf() const { return 1 / (2 * kPiD * oneMinusCos_); } // 1/sr, within it

  private:
    static constexpr double kSteps = 0x1p-22; // four half steps of a float near 1

    AimCone(Vec3d axis, double sin2) : axis_(axis), sin2_(sin2), oneMinusCos_(sin2 / (1 + std::sqrt(1 - sin2))) {}

    Vec3d axis_; // unit
    double sin2_, oneMinusCos_;
};

// A piecewise-constant density over the unit square, from which AimCone and the disks of lights far away take their
// directions and places: areas are kept, so that densities carry over.
class AimGrid {
  public:
    static constexpr std::size_t kFinest = 16; // cells of a row

    // Row by row, as many as columns. Requires: > 0 and finite, a square number of them.
    AimGrid(std::span<const double> weights, std::size_t row) : row_(row), cells_(weights, row) {
        for (std::size_t i = 0; i < weights.size(); ++i)
            densities_.push_back(cells_.probability(i % row, i / row) * static_cast<double>(weights.size()));
    }
    // The cell of a grid of n × n that v in [0, 1]² lies in.
    static std::size_t cell(Vec2 v, std::size_t n) {
        const auto at = [n](float x) {
            return std::min(static_cast<std::size_t>(std::max(x, 0.f) * static_cast<float>(n)), n - 1);
        };
        return at(v.y) * n + at(v.x);
    }

    Vec2 sample(Vec2 u) const noexcept {
        const CellSample c = cells_.sample(u);
        const auto n = static_cast<float>(row_);
        return {(static_cast<float>(c.column) + c.offset.x) / n, (static_cast<float>(c.row) + c.offset.y) / n};
    }
    double density(Vec2 v) const noexcept { return densities_[cell(v, row_)]; } // over an even one

  private:
    std::size_t row_;
    Distribution2D cells_;
    std::vector<double> densities_;
};

} // namespace abbe
