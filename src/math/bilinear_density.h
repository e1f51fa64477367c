// Densities over the unit square that are bilinear.
#pragma once

#include "math/vec.h"

#include <array>

namespace abbe {

// Over the unit square, in proportion to what is bilinear between its values at the corners (0, 0), (1, 0), (0, 1) and
// (1, 1). Requires all >= 0, not all 0.
struct BilinearDensity {
    std::array<float, 4> corner;

    // u in [0, 1)².
    Vec2 sample(Vec2 u) const {
        const float y = linear(u.y, corner[0] + corner[1], corner[2] + corner[3]);
        return {linear(u.x, lerp(corner[0], corner[2], y), lerp(corner[1], corner[3], y)), y};
    }
    float pdf(Vec2 p) const {
        const float value = lerp(lerp(corner[0], corner[1], p.x), lerp(corner[2], corner[3], p.x), p.y);
        return 4 * value / (corner[0] + corner[1] + corner[2] + corner[3]);
    }

  private:
    // In proportion to a + (b - a) x.
    static float linear(float u, float a, float b) {
        if (!(u > 0)) return 0;
        const float x = u * (a + b) / (a + std::sqrt(lerp(a * a, b * b, u)));
        return std::min(x, kOneMinusEpsilon);
    }
};

} // namespace abbe
