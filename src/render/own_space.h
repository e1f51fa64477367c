// The space of a shape before its transform, in which patterns stick to it.
#pragma once

#include "math/transform.h"
#include "render/surface_hit.h"

#include <cmath>

namespace abbe {

class OwnSpace {
  public:
    // `map`: from the coordinates of the shape.
    explicit OwnSpace(const Transform& map)
        : map_(map), scale_(static_cast<float>(std::cbrt(std::abs(map.determinant())))) {}

    // Turns `local`, a point in the coordinates of the shape, and completes what goes with it in SurfaceHit.
    void complete(SurfaceHit& hit) const {
        hit.local = Vec3(map_.point(Vec3d(hit.local)));
        hit.localNormal = Vec3(normalize(map_.normal(Vec3d(hit.shading.z))));
        hit.localScale = scale_;
        const auto& a = map_.a;
        hit.localX = Vec3(Vec3d(a[0][0], a[0][1], a[0][2]));
        hit.localY = Vec3(Vec3d(a[1][0], a[1][1], a[1][2]));
        hit.localZ = Vec3(Vec3d(a[2][0], a[2][1], a[2][2]));
    }

  private:
    Transform map_;
    float scale_; // of lengths
};

} // namespace abbe
