// Voxel grids in a scene: at their place, as colours, and moving.
#pragma once

#include "base/check.h"
#include "spectrum/upsampling_table.h"
#include "volumes/voxel_grid.h"

#include <memory>
#include <optional>

namespace abbe {

// A voxel grid that has its place in a scene. Owns the grid. Immutable, thread-safe.
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

    Value at(float t) noexcept {
        const __m256d p = _mm256_fmadd_pd(four(direction_), _mm256_set1_pd(static_cast<double>(t)), four(origin_));
        return sampler_.at(_mm256_cvtpd_ps(p));
    }
    // Beside the line by `shift`, in render space.
    Value at(float t, Vec3d shift) noexcept {
        return sampler_.at(Vec3(origin_ + direction_ * static_cast<double>(t) + toIndex_->vector(shift)));
    }

  private:
    static __m256d four(const Vec3d& v) { return _mm256_maskload_pd(&v.x, _mm256_setr_epi64x(-1, -1, -1, 0)); }

    typename BasicVoxelGrid<Value>::Sampler sampler_;
    const Transform* toIndex_;
    Vec3d origin_, direction_;
};

// Colour of what scatters, from RGB voxels. A share of the albedo, from scene-linear RGB in [0, 1]; components outside
// count as the nearest within. The table is for the RGB space of the voxels.
struct GridColor {
    GridField<Vec3> field;
    std::unique_ptr<const UpsamplingTable> table;
};

// Along a line of render space, for one thread. Requires a color for anything but construction.
class ColorAlong {
  public:
    ColorAlong(const GridColor* color, Vec3d origin, Vec3d direction) : color_(color) {
        if (color) field_.emplace(color->field, origin, direction);
    }
    Spectrum at(float t, const Wavelengths& w) noexcept { return color_->table->lookup(field_->at(t)).at(w); }
    Spectrum at(float t, Vec3d shift, const Wavelengths& w) noexcept {
        return color_->table->lookup(field_->at(t, shift)).at(w);
    }

  private:
    const GridColor* color_;
    std::optional<FieldAlong<Vec3>> field_;
};

// How a field drifts while the shutter is open. As a file states it.
struct GridVelocity {
    VectorGrid grid;     // in the file's own world, per second
    double scale = 1;    // factor of it
    double first = 0;    // s from the moment of the file's fields to the opening of the shutter
    double duration = 0; // s that it is open, >= 0
};

// Fields that drift while the shutter is open. What is at x now was at x - v(x) s when the file's fields were taken, s
// seconds ago. Immutable, thread-safe.
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
