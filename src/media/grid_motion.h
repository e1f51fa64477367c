// Fields that drift while the shutter is open.
#pragma once

#include "media/grid_field.h"

#include <optional>

namespace abbe {

// As a file states it.
struct GridVelocity {
    VectorGrid grid;     // in the file's own world, per second
    double scale = 1;    // factor of it
    double first = 0;    // s from the moment of the file's fields to the opening of the shutter
    double duration = 0; // s that it is open, >= 0
};

// What is at x now was at x - v(x) s when the file's fields were taken, s seconds ago. Immutable, thread-safe.
class GridMotion {
  public:
    GridMotion(GridVelocity, const Transform& worldToRender);

    bool moves() const { return longestWay_ > 0; }

  private:
    friend class MotionAlong;
    friend double driftInVoxels(const GridMotion&, const GridField<float>&);
    GridField<Vec3> velocity_;
    Transform toRender_; // of vectors, with the factor
    double first_, duration_;
    double longestWay_; // that anything goes, in the file's world over the factor
};

// How far the things of a grid drift at most, along any axis, in its voxels.
double driftInVoxels(const GridMotion&, const GridField<float>&);
double driftInVoxels(const GridVelocity&, const VoxelGrid&, const Transform& worldToRender);

// The motion along a line of render space at one time, for one thread. Null motions are none and cost a comparison.
class MotionAlong {
  public:
    MotionAlong(const GridMotion* motion, Vec3d origin, Vec3d direction, float time) : motion_(motion) {
        if (!motion) return;
        velocity_.emplace(motion->velocity_, origin, direction);
        seconds_ = motion->first_ + motion->duration_ * static_cast<double>(time);
    }
    bool moves() const { return motion_ != nullptr; }
    // From a point to where what is there came from, render space. Requires moves().
    Vec3d shift(float t) noexcept { return motion_->toRender_.vector(Vec3d(velocity_->at(t)) * -seconds_); }

  private:
    const GridMotion* motion_;
    std::optional<FieldAlong<Vec3>> velocity_;
    double seconds_ = 0;
};

} // namespace abbe
