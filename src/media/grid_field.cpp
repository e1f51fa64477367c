#include "media/grid_field.h"

namespace abbe {

namespace {

Transform vectorsToRender(const GridVelocity& v, const Transform& worldToRender) {
    return Transform::scale({v.scale, v.scale, v.scale}).then(worldToRender);
}

// Interpolated vectors are no longer than those of the voxels; a row of a linear map times a vector is at most the
// product of their lengths.
double furthest(const Transform& velocityToIndex, double distance) {
    double most = 0;
    for (const auto& row : velocityToIndex.a) most = std::max(most, std::hypot(row[0], row[1], row[2]));
    return most * distance;
}

// In the file's world, before the factor of the velocity.
double longestWay(const VectorGrid& grid, double first, double duration) {
    return static_cast<double>(length(grid.maximum())) * std::max(std::abs(first), std::abs(first + duration));
}

} // namespace

GridMotion::GridMotion(GridVelocity v, const Transform& worldToRender)
    : velocity_(std::move(v.grid), worldToRender), toRender_(vectorsToRender(v, worldToRender)), first_(v.first),
      duration_(v.duration), longestWay_(v.scale != 0 ? longestWay(velocity_.grid(), first_, duration_) : 0) {}

double driftInVoxels(const GridVelocity& v, const VoxelGrid& grid, const Transform& worldToRender) {
    const auto toIndex = grid.indexToWorld().then(worldToRender).inverse();
    ABBE_CHECK(toIndex.has_value());
    return furthest(vectorsToRender(v, worldToRender).then(*toIndex), longestWay(v.grid, v.first, v.duration));
}

double driftInVoxels(const GridMotion& motion, const GridField<float>& field) {
    return furthest(motion.toRender_.then(field.toIndex()), motion.longestWay_);
}

} // namespace abbe
