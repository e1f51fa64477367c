// Where a ray met a surface, with all that shading needs.
#pragma once

#include "math/frame.h"

#include <bit>
#include <cstdint>

namespace abbe {

class Material;
class Light;

// Render space. Plain data, filled by Intersector::intersect.
struct SurfaceHit {
    Vec3 p;             // the point, from barycentrics, not from o + t d
    float distance = 0; // along the ray
    Vec3 pError;        // bound on the absolute error of p, per axis
    Vec3 ng;            // unit geometric normal; points to the outside of closed shapes
    Frame shading;      // z is the shading normal, in ng's hemisphere
    Vec2 uv;
    const Material* material = nullptr;
    const Light* light = nullptr; // the area light that this surface is, or null
    std::uint32_t primitive = 0;  // within its shape
};

// The next float away from zero in the direction of `away` for a coordinate offset (256 ulp, or 2^-16 near zero)
// [Wachter2019].
inline float offsetUlps(float x, float n) {
    const auto steps = static_cast<std::int32_t>(256.f * n);
    const float moved = std::bit_cast<float>(std::bit_cast<std::int32_t>(x) + (x < 0 ? -steps : steps));
    return std::abs(x) < 1.f / 32 ? x + n * (1.f / 65536) : moved;
}

// An origin on the side of the surface towards which `w` leaves, far enough that no ray meets the surface again: the
// larger of the error bound of the point [Pharr2023, ch. 6.8] and Wächter and Binder's integer offset, per axis.
inline Vec3 spawnOrigin(Vec3 p, Vec3 pError, Vec3 ng, Vec3 w) {
    const Vec3 n = dot(w, ng) < 0 ? -ng : ng;
    const float bound = dot(abs(n), pError);
    const auto axis = [bound](float x, float nx) {
        const float a = x + nx * bound, b = offsetUlps(x, nx);
        return nx < 0 ? std::min(a, b) : std::max(a, b);
    };
    return {axis(p.x, n.x), axis(p.y, n.y), axis(p.z, n.z)};
}

inline Vec3 spawnOrigin(const SurfaceHit& hit, Vec3 w) { return spawnOrigin(hit.p, hit.pError, hit.ng, w); }

} // namespace abbe
