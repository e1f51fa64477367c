// A surface next to one of its points, in double.
#pragma once

#include "math/vec.h"

#include <array>
#include <utility>

namespace abbe {

// Two unit vectors that are orthogonal to the unit vector n and to each other [Duff2017, listing 3].
inline std::pair<Vec3d, Vec3d> tangentsOf(Vec3d n) {
    const double sign = std::copysign(1.0, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
    return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}};
}

// Where a line meets a surface, and how the shading normal turns there: what it takes to follow a narrow beam beyond
// mirrors and lenses. In double, since a lens magnifies the rounding of its own points. Of a flat surface it is the
// plane; of a triangle with vertex normals the interpolated normal, which is the one that refracts.
struct SurfacePatch {
    Vec3d p;
    Vec3d ng;                    // unit, outside
    Vec3d n;                     // unit, in ng's hemisphere: the shading normal
    std::array<Vec3d, 2> along;  // 1/m: as p moves by dp within the surface, n changes by
    std::array<Vec3d, 2> change; //      change[0] (along[0] · dp) + change[1] (along[1] · dp)

    Vec3d normalChange(Vec3d dp) const { return change[0] * dot(along[0], dp) + change[1] * dot(along[1], dp); }
};

} // namespace abbe
