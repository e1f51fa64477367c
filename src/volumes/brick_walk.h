// A ray's way through the bricks of a voxel field.
#pragma once

#include "volumes/brick_bounds.h"

#include <bit>
#include <cmath>
#include <cstdint>

namespace abbe {

struct BrickSegment {
    float tNear = 0, tFar = 0; // tNear < tFar
    float minimum = 0, mean = 0, maximum = 0;
};

// Walks origin + t·direction, given in index space (direction of any length: t is the caller's own), for t in [t0, t1].
// next() gives the segments in which the field may be other than 0, in order of t and without overlap; between two
// segments that do not touch, before the first and after the last the field is 0. A segment is a brick, or a larger
// cell where that is constant or thin (see extinctionPerT). t1 may be infinite, components of the direction 0; nothing
// comes for rays that are not finite. Does not allocate, is trivially destructible, and must not outlive the bounds.
class BrickWalk {
  public:
    // A larger cell is passed in one segment if maximum · extinctionPerT · (tFar - tNear) <= 1/4: in nearly empty space
    // more steps than collisions are a waste. Not more, because a mean over a larger cell is a worse control.
    // Infinite: single bricks always (but for constant regions).
    BrickWalk(const BrickBounds& bounds, Vec3d origin, Vec3d direction, float t0, float t1,
              float extinctionPerT = kInfinity) noexcept
        : bounds_(&bounds), extinction_(extinctionPerT) {
        done_ = bounds.empty() || !start(origin, direction, t0, t1);
    }

    // The next segment; false after the last.
    bool next(BrickSegment& segment) noexcept {
        while (!done_) {
            const BrickBounds::Node& node = bounds_->nodes_[stack_[level_]];
            if (node.constant()) {
                if (pass(3 * level_, node.bounds, segment)) return true;
            } else if (level_ == 1) {
                if (passBricks(node, segment)) return true;
            } else if (goesDown(node)) {
                if (pass(3 * (level_ - 1), bounds_->nodes_[stack_[level_ - 1]].bounds, segment)) return true;
            }
        }
        return false;
    }

  private:
    static constexpr int kMostLevels = 9;
    static constexpr float kThin = 0.25f;

    struct Exit {
        double t;
        int axis;
    };

    bool start(Vec3d origin, Vec3d direction, float t0, float t1) noexcept;

    // Where the ray leaves the cell of 2^shift bricks a side that it is in. The same plane gives the same t at all
    // levels.
    Exit exitOf(int shift) const noexcept {
        double t[3];
        for (int a = 0; a < 3; ++a) {
            const std::uint32_t cell = (c_[a] >> shift) + ahead_[a];
            t[a] = std::fma(static_cast<double>(std::int64_t{cell} << (shift + 3)), inverse_[a], offset_[a]);
        }
        Exit exit{t[0], 0};
        if (t[1] < exit.t) exit = {t[1], 1};
        if (t[2] < exit.t) exit = {t[2], 2};
        return exit;
    }

    // Enters the child that it is in, unless there is none, which it leaves, or it is thin: true, and it is passed as a
    // whole.
    bool goesDown(const BrickBounds::Node& node) noexcept {
        const int shift = 3 * (level_ - 1);
        const std::uint32_t child = childAt(shift);
        if (!node.has(child)) return leave(shift), false;
        const std::uint32_t index = stack_[level_ - 1] = node.index(child);
        const float most = bounds_->nodes_[index].bounds.maximum * extinction_;
        if (most * static_cast<float>(std::min(exitOf(shift).t, end_) - t_) <= kThin) return true;
        --level_;
        return false;
    }
    std::uint32_t childAt(int shift) const noexcept {
        return (c_[0] >> shift & 7) << 6 | (c_[1] >> shift & 7) << 3 | (c_[2] >> shift & 7);
    }

    // Through the bricks of a node up to one that gives a segment; false if it has left the node before. Keeps the next
    // planes of bricks: only that of the axis crossed changes.
    bool passBricks(const BrickBounds::Node& node, BrickSegment& segment) noexcept {
        if (!planesKnown_) {
            for (int a = 0; a < 3; ++a) plane_[a] = planeOf(a);
            planesKnown_ = true;
        }
        do {
            const double before = t_;
            const std::uint32_t child = childAt(0);
            leaveBrick();
            if (!node.has(child)) continue;
            const float near = static_cast<float>(before), far = static_cast<float>(t_);
            if (!(near < far)) continue;
            const FieldBounds& b = bounds_->bricks_[node.index(child)];
            segment = {near, far, b.minimum, b.mean, b.maximum};
            return true;
        } while (level_ == 1 && !done_);
        return false;
    }
    // The same as leave(0).
    void leaveBrick() noexcept {
        int axis = plane_[1] < plane_[0] ? 1 : 0;
        axis = plane_[2] < plane_[axis] ? 2 : axis;
        if (!(plane_[axis] < end_)) {
            t_ = end_;
            done_ = true;
            return;
        }
        t_ = std::max(t_, plane_[axis]);
        const std::uint32_t brick = c_[axis];
        c_[axis] = brick + 2 * ahead_[axis] - 1;
        plane_[axis] = planeOf(axis);
        climb(brick ^ c_[axis]);
    }
    double planeOf(int a) const noexcept {
        return std::fma(static_cast<double>(std::int64_t{c_[a] + ahead_[a]} * 8), inverse_[a], offset_[a]);
    }

    // Goes up to the node that holds the new cell too, given the bits in which its coordinate differs.
    void climb(std::uint32_t difference) noexcept {
        if (difference < 8 && level_ == 1) return;
        const int highest = 31 - std::countl_zero(difference);
        level_ = std::max(level_, highest / 3 + 1);
        if (level_ > bounds_->levels_) done_ = true;
    }

    // Gives the rest of the cell as a segment, unless it is too short for float, and leaves it.
    bool pass(int shift, const FieldBounds& b, BrickSegment& segment) noexcept {
        const float near = static_cast<float>(t_);
        leave(shift);
        const float far = static_cast<float>(t_);
        if (!(near < far)) return false;
        segment = {near, far, b.minimum, b.mean, b.maximum};
        return true;
    }

    // Moves to the next cell: t_, c_ and level_. Sets done_ at the end.
    void leave(int shift) noexcept {
        const Exit exit = exitOf(shift);
        if (!(exit.t < end_)) {
            t_ = end_;
            done_ = true;
            return;
        }
        t_ = std::max(t_, exit.t); // rounding may put a crossing before the last one
        if (shift > 0) follow(shift, exit.axis);
        const int a = exit.axis;
        const std::uint32_t before = c_[a];
        c_[a] = (((before >> shift) + ahead_[a]) << shift) - (ahead_[a] ^ 1);
        planesKnown_ = false;
        climb(before ^ c_[a]);
    }

    // Finds the brick at t_ along the axes other than `crossed`. It stays inside the large cell and never goes back.
    void follow(int shift, int crossed) noexcept {
        for (int a = 0; a < 3; ++a) {
            if (a == crossed || direction_[a] == 0) continue;
            const double low = static_cast<double>(c_[a] >> shift << shift);
            const double high = low + static_cast<double>((std::uint32_t{1} << shift) - 1);
            const double now = static_cast<double>(c_[a]);
            const double at = std::floor(std::fma(t_, direction_[a], origin_[a]) * 0.125);
            c_[a] = static_cast<std::uint32_t>(ahead_[a] ? std::clamp(at, now, high) : std::clamp(at, low, now));
        }
    }

    const BrickBounds* bounds_;
    float extinction_;
    bool done_ = false, planesKnown_ = false;
    int level_ = 0;               // of the node stack_[level_], among whose children c_ is
    std::uint32_t c_[3] = {};     // brick, relative to the tree's origin
    std::uint32_t ahead_[3] = {}; // 1 where the direction is positive
    std::uint32_t stack_[kMostLevels + 1] = {};
    double origin_[3] = {}, direction_[3] = {}; // relative to the tree's origin, in voxels
    double inverse_[3] = {}, offset_[3] = {};   // t of a plane x: x · inverse + offset
    double plane_[3] = {};                      // t of the next planes between bricks, when planesKnown_
    double t_ = 0, end_ = 0;
};

inline bool BrickWalk::start(Vec3d origin, Vec3d direction, float t0, float t1) noexcept {
    if (!isFinite(origin) || !isFinite(direction)) return false;
    t_ = t0;
    end_ = t1;
    for (int a = 0; a < 3; ++a) {
        const double low = 0, high = 8.0 * bounds_->size_[a];
        origin_[a] = origin[a] - 8.0 * bounds_->origin_[a];
        direction_[a] = std::abs(direction[a]) < 1e-290 ? 0 : direction[a]; // the inverse would overflow
        ahead_[a] = direction_[a] > 0 ? 1 : 0;
        if (direction_[a] == 0) {
            offset_[a] = std::numeric_limits<double>::infinity(); // and inverse 0: never crosses a plane
            if (!(origin_[a] >= low && origin_[a] < high)) return false;
            continue;
        }
        inverse_[a] = 1 / direction_[a];
        offset_[a] = -origin_[a] * inverse_[a];
        const double tLow = std::fma(low, inverse_[a], offset_[a]), tHigh = std::fma(high, inverse_[a], offset_[a]);
        t_ = std::max(t_, std::min(tLow, tHigh));
        end_ = std::min(end_, std::max(tLow, tHigh));
    }
    if (!(t_ < end_)) return false;
    for (int a = 0; a < 3; ++a) {
        const double at =
            std::floor((direction_[a] == 0 ? origin_[a] : std::fma(t_, direction_[a], origin_[a])) * 0.125);
        c_[a] = static_cast<std::uint32_t>(std::clamp(at, 0.0, static_cast<double>(bounds_->size_[a] - 1)));
    }
    level_ = bounds_->levels_;
    stack_[level_] = bounds_->root_;
    return true;
}

} // namespace abbe
