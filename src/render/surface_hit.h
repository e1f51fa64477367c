// Where a ray hit a surface, with all that shading needs.
#pragma once

#include "math/frame.h"
#include "math/transform.h"
#include "math/vec.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace abbe {

// Two unit vectors that are orthogonal to the unit vector n and to each other [Duff2017, listing 3].
inline std::pair<Vec3d, Vec3d> tangentsOf(Vec3d n) {
    const double sign = std::copysign(1.0, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
    return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}};
}

// A surface next to one of its points, in double. Where a line meets a surface, and how the shading normal turns there:
// what it takes to follow a narrow beam beyond mirrors and lenses. In double, since a lens magnifies the rounding of
// its own points. Of a flat surface it is the plane; of a triangle with vertex normals the interpolated normal, which
// is the one that refracts.
struct SurfacePatch {
    Vec3d p;
    Vec3d ng;                    // unit, outside
    Vec3d n;                     // unit, in ng's hemisphere: the shading normal
    std::array<Vec3d, 2> along;  // 1/m: as p moves by dp within the surface, n changes by
    std::array<Vec3d, 2> change; //      change[0] (along[0] · dp) + change[1] (along[1] · dp)

    Vec3d normalChange(Vec3d dp) const { return change[0] * dot(along[0], dp) + change[1] * dot(along[1], dp); }
};

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

    // Of the path that hit the surface.
    Vec3 arrival;                   // unit direction in which it came; set for materials that bend, are open or use
                                    // textures
    float footprint = 0;            // radius of its cone here, m; 0: a point
    const Curve* outside = nullptr; // index of what lies on the outer side; null: air, 1
};

// An origin on the side of the surface towards which `w` leaves, so far that no ray hits the surface again and no
// farther, because the next surface may be a sheet of paper: the error bound of the point along the normal
// [Pharr2023, ch. 6.8]. It scales with the coordinates, so there is no smallest offset (docs/hard_cases.md, cases
// 1-3 and 8).
inline Vec3 spawnOrigin(Vec3 p, Vec3 pError, Vec3 ng, Vec3 w) {
    const float bound = dot(abs(ng), pError);
    return p + ng * (dot(w, ng) < 0 ? -bound : bound);
}

inline Vec3 spawnOrigin(const SurfaceHit& hit, Vec3 w) { return spawnOrigin(hit.p, hit.pError, hit.ng, w); }

// The space of a shape before its transform, in which patterns stick to it.
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
