// Where a ray met a surface, with all that shading needs.
#pragma once

#include "math/frame.h"

#include <cstdint>

namespace abbe {

class Curve;
class Material;
class SurfaceLight;
class Shape;

// Render space. Plain data, filled by Intersector::intersect.
struct SurfaceHit {
    Vec3 p;             // the point, from barycentrics, not from o + t d
    float distance = 0; // along the ray
    Vec3 pError;        // bound on the absolute error of p, per axis
    Vec3 ng;            // unit geometric normal; points to the outside of closed shapes
    Frame shading;      // z is the shading normal, in ng's hemisphere
    Vec2 uv;
    const Material* material = nullptr;
    const SurfaceLight* light = nullptr; // that this surface is, or null
    std::uint32_t primitive = 0;         // within its shape
    static constexpr std::uint32_t kNoInstance = 0xffffffffu;
    std::uint32_t instance = kNoInstance; // number of the outermost placement that it belongs to

    // The parametrisation, only for materials that look at textures (Material::usesTextures).
    Vec3 dpdu, dpdv; // how p changes with uv; 0 where the shape has no texture coordinates
    Vec3 local;      // p in the shape's own space, before its transform, m
    Vec3 localX{1, 0, 0}, localY{0, 1, 0}, localZ{0, 0, 1}; // gradient of each coordinate of `local`, render space
    Vec3 localNormal;                                       // the shading normal there, unit
    float localScale = 1;                // m there per m of render space, in the mean over directions
    const Shape* shape = nullptr;        // whose attributes `part`, `primitive` and `barycentric` find
    std::uint32_t part = 0, element = 0; // as in RawHit: the sink's call, and the primitive in it
    Vec2 barycentric;

    // Of the path that met the surface.
    Vec3 arrival;                   // unit direction in which it came; set for materials that bend, are open or use
                                    // textures
    float footprint = 0;            // radius of its cone here, m; 0: a point
    const Curve* outside = nullptr; // index of what lies on the outer side; null: air, 1
};

// An origin on the side of the surface towards which `w` leaves, so far that no ray meets the surface again and no
// farther, because the next surface may be a sheet of paper: the error bound of the point along the normal
// [Pharr2023, ch. 6.8]. It scales with the coordinates, so there is no smallest offset (docs/hard_cases.md, cases
// 1-3 and 8).
inline Vec3 spawnOrigin(Vec3 p, Vec3 pError, Vec3 ng, Vec3 w) {
    const float bound = dot(abs(ng), pError);
    return p + ng * (dot(w, ng) < 0 ? -bound : bound);
}

inline Vec3 spawnOrigin(const SurfaceHit& hit, Vec3 w) { return spawnOrigin(hit.p, hit.pError, hit.ng, w); }

} // namespace abbe
