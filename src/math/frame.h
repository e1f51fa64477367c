// Orthonormal shading frame: local +z is the normal.
#pragma once

#include "math/vec.h"

namespace abbe {

struct Frame {
    Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

    // Any frame about the unit vector n, without a singularity [Duff2017, listing 3].
    static Frame fromNormal(Vec3 n) {
        const float sign = std::copysign(1.f, n.z);
        const float a = -1 / (sign + n.z);
        const float b = n.x * n.y * a;
        return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
    }
    // Frame about n whose x lies along `tangent` as far as n allows; falls back to fromNormal.
    static Frame fromNormalTangent(Vec3 n, Vec3 tangent) {
        const Vec3 t = tangent - n * dot(n, tangent);
        const float l2 = lengthSquared(t);
        if (!(l2 > 1e-12f * lengthSquared(tangent))) return fromNormal(n);
        const Vec3 u = t * (1 / std::sqrt(l2));
        return {u, cross(n, u), n};
    }

    Vec3 toLocal(Vec3 v) const { return {dot(v, x), dot(v, y), dot(v, z)}; }
    Vec3d toLocal(Vec3d v) const { return {dot(v, Vec3d(x)), dot(v, Vec3d(y)), dot(v, Vec3d(z))}; }
    Vec3 toWorld(Vec3 v) const { return x * v.x + y * v.y + z * v.z; }
};

} // namespace abbe
