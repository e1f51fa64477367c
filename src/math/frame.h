// Shading frames and normals.
#pragma once

#include "math/vec.h"

#include <algorithm>

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

// Shading normals that are never seen from behind and never mirror the view into the surface.
// The unit vector nearest to `n` in the sense that a mirror there shows what lies above the surface: where the
// direction `wo` mirrored at n would fall below a small elevation over the plane of `ng`, it is lifted to that
// elevation, and the normal is the one halfway to it [Keller2017, sec. A.3; Reshetov2010]. All on the side of ng: wo
// may be seen from either side, n and the result lie in ng's hemisphere. ng, n: unit; wo: unit towards the eye, or 0 if
// it is not known, and then only the hemisphere is looked after.
inline Vec3 consistentNormal(Vec3 ng, Vec3 n, Vec3 wo) {
    const float height = dot(n, ng);
    if (!(height > 0)) { // the nearest one above the surface
        n = n - ng * (height - 1e-3f);
        n = n * (1 / length(n));
    }
    // In double: near grazing incidence the two directions nearly cancel.
    const double side = dot(wo, ng) < 0 ? -1 : 1;
    const Vec3d outer = Vec3d(ng) * side, eye = normalize(Vec3d(wo));
    const double up = dot(eye, outer), lowest = std::min(0.9 * up, 0.01);
    if (!(up > 0)) return n;
    Vec3d facing = Vec3d(n) * side; // where it turns its back on the eye, as if it were seen edge-on: nothing jumps
    const double back = std::min(0.0, dot(facing, eye));
    facing = facing - eye * back;
    const Vec3d mirrored = facing * (2 * dot(facing, eye) / lengthSquared(facing)) - eye;
    const double elevation = dot(mirrored, outer);
    if (back == 0 && elevation >= lowest) return n;
    const Vec3d along = mirrored - outer * elevation;
    const double l2 = lengthSquared(along);
    if (!(l2 > 1e-20)) return ng; // straight into the surface
    const Vec3d half = eye + along * std::sqrt((1 - lowest) * (1 + lowest) / l2) + outer * lowest; // never 0
    return Vec3(half * (side / length(half)));
}

} // namespace abbe
