// A voxel grid that has its place in a scene.
#pragma once

#include "base/check.h"
#include "volumes/voxel_grid.h"

namespace abbe {

// Owns the grid. Immutable, thread-safe.
template <typename Value> class GridField {
  public:
    // `worldToRender` places the grid's own world. Requires an invertible transform.
    GridField(BasicVoxelGrid<Value> grid, const Transform& worldToRender)
        : grid_(std::move(grid)), toRender_(grid_.indexToWorld().then(worldToRender)) {
        const auto inverse = toRender_.inverse();
        ABBE_CHECK(inverse.has_value());
        toIndex_ = *inverse;
    }

    const BasicVoxelGrid<Value>& grid() const { return grid_; }
    const Transform& toRender() const { return toRender_; } // from index space
    const Transform& toIndex() const { return toIndex_; }

  private:
    BasicVoxelGrid<Value> grid_;
    Transform toRender_, toIndex_;
};

// A field along a line of render space, for one thread. In double: far from the grid's origin a place in float would
// miss the bounds of its brick. Must not outlive the field.
template <typename Value> class FieldAlong {
  public:
    FieldAlong(const GridField<Value>& field, Vec3d origin, Vec3d direction)
        : sampler_(field.grid().sampler()), toIndex_(&field.toIndex()), origin_(toIndex_->point(origin)),
          direction_(toIndex_->vector(direction)) {}

    Vec3d origin() const { return origin_; } // index space
    Vec3d direction() const { return direction_; }

    Value at(float t) noexcept { return sampler_.at(Vec3(origin_ + direction_ * static_cast<double>(t))); }
    // Beside the line by `shift`, in render space.
    Value at(float t, Vec3d shift) noexcept {
        return sampler_.at(Vec3(origin_ + direction_ * static_cast<double>(t) + toIndex_->vector(shift)));
    }

  private:
    typename BasicVoxelGrid<Value>::Sampler sampler_;
    const Transform* toIndex_;
    Vec3d origin_, direction_;
};

} // namespace abbe
