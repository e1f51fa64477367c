// The area that a map from the unit square gives to a point: for a sampler of directions it is 1 over the density.
#pragma once

#include "math/vec.h"

#include <cmath>
#include <optional>

namespace abbe::test {

// |∂w/∂x × ∂w/∂y| of map: Vec2 -> optional<Vec3> (unit directions) at u, by central differences of step h. Nothing
// where the map is undefined nearby. The steps are taken as the floats really differ, so h may be as small as 1e-4.
template <typename Map> std::optional<double> jacobian(Map&& map, Vec2 u, float h) {
    const Vec2 x0{u.x - h, u.y}, x1{u.x + h, u.y}, y0{u.x, u.y - h}, y1{u.x, u.y + h};
    const auto wx0 = map(x0), wx1 = map(x1), wy0 = map(y0), wy1 = map(y1);
    if (!wx0 || !wx1 || !wy0 || !wy1) return std::nullopt;
    const Vec3d dx = (Vec3d(*wx1) - Vec3d(*wx0)) / (static_cast<double>(x1.x) - x0.x);
    const Vec3d dy = (Vec3d(*wy1) - Vec3d(*wy0)) / (static_cast<double>(y1.y) - y0.y);
    return length(cross(dx, dy));
}

} // namespace abbe::test
