// A window through which light from far away enters a room, and directions through it in proportion to what is seen
// there.
#pragma once

#include "math/frame.h"
#include "render/receiver.h"

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace abbe {

// A rectangular opening. The environment is tabulated over the two angles of a direction against the opening's axes,
// in which any receiver sees the opening as a rectangle: a summed-area table then samples just what is seen through it
// [Bitterli2015]. Render space; immutable, thread-safe.
class Portal {
  public:
    // Corners in order around it, counter-clockwise seen from the room. `luminance` is asked for unit directions that
    // leave the room, about 2 million times. Requires: a rectangle (isRectangle), finite luminance >= 0.
    // One that lies as `alike` does, in a wall parallel to its, shares the table of it; luminance is not asked then.
    Portal(const std::array<Vec3d, 4>& corners, const std::function<double(Vec3)>& luminance,
           const Portal* alike = nullptr);
    static bool isRectangle(const std::array<Vec3d, 4>& corners);

    // What a receiver sees of it: bounds of the two angles, from 0 to 1 as the table has them, and the table's weight.
    struct View {
        double a0, a1, b0, b1;
        double weight; // > 0
    };
    // Nothing from outside of the room, and where it is too narrow to be told from nothing.
    std::optional<View> view(const Receiver&) const noexcept;

    // A direction and its density over solid angle; u in [0, 1)².
    struct Sample {
        Vec3 w;
        float pdf;
    };
    Sample sample(const View&, Vec2 u) const noexcept;
    float pdf(const View&, Vec3 w) const noexcept; // 0 where w misses the opening

    bool inside(Vec3 p) const noexcept { return dot(centre_ - p, frame_.z) > 0; } // on the room's side of its plane
    // None of it lies in front of an opaque surface.
    bool behind(const Receiver&) const noexcept;
    // Of the half of all directions in front of a wall those through the opening, roughly: at most 1, 0 from outside.
    float share(Vec3 p) const noexcept;
    bool crosses(Vec3 p, Vec3 w) const noexcept; // whether a ray from p leaves the room through the opening

  private:
    static constexpr int kSize = 512;  // cells along each angle
    using Table = std::vector<double>; // sums over all cells below, (kSize + 1)²
    Table tabulate(const std::function<double(Vec3)>& luminance) const;
    double at(std::size_t i, std::size_t j) const noexcept { return (*table_)[i * (kSize + 1) + j]; }
    static std::size_t cellOf(double unit) noexcept {
        return std::min(static_cast<std::size_t>(unit * kSize), static_cast<std::size_t>(kSize - 1));
    }
    double sumBelow(std::size_t row, double b) const noexcept;
    double sum(double a, double b) const noexcept;
    double weight(double a0, double a1, double b0, double b1) const noexcept;
    double density(const View&, double a, double b) const noexcept; // over the two angles

    Frame frame_; // z leaves the room
    Vec3 centre_;
    double halfWidth_, halfHeight_;
    std::shared_ptr<const Table> table_;
};

} // namespace abbe
