// Distances along a ray, drawn by how near they come to a point [Kulla2012, §4.1].
#pragma once

#include "math/vec.h"

#include <algorithm>
#include <cmath>

namespace abbe {

// Density proportional to the inverse square of the distance from the point, on [tNear, tFar] of the ray; tFar may be
// infinite. Seen from the point, equal angles are equally likely.
class EquiangularDistances {
  public:
    // Requires a unit direction.
    EquiangularDistances(Vec3 origin, Vec3 direction, Vec3 point, float tNear, float tFar) {
        const Vec3d to = Vec3d(point) - Vec3d(origin);
        closest_ = dot(to, Vec3d(direction));
        const Vec3d aside = to - Vec3d(direction) * closest_;
        // On the ray itself the inverse square has no integral.
        height_ = std::max(length(aside), 1e-3 * length(to) + 1e-30);
        near_ = static_cast<double>(tNear);
        far_ = static_cast<double>(tFar);
        from_ = std::atan((near_ - closest_) / height_);
        spread_ = std::atan((far_ - closest_) / height_) - from_;
    }

    // False where the range is too small or too far away for its angles.
    bool valid() const { return spread_ > 1e-9 && spread_ < 4; }
    // u in [0, 1). Requires valid().
    float sample(float u) const {
        const double t = closest_ + height_ * std::tan(from_ + static_cast<double>(u) * spread_);
        return static_cast<float>(std::clamp(t, near_, far_));
    }
    // 1 per unit of distance; 0 outside. Requires valid().
    float pdf(float t) const {
        const double x = static_cast<double>(t);
        if (!(x >= near_ && x <= far_)) return 0;
        const double away = x - closest_;
        return static_cast<float>(height_ / (spread_ * (height_ * height_ + away * away)));
    }

  private:
    double closest_, height_, near_, far_, from_, spread_;
};

} // namespace abbe
