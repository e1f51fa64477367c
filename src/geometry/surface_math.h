// Small formulas shared by the shapes: rounding bounds, triangle normals, the change from area to solid angle; and
// where a time lies among equally spaced steps, in Embree's own arithmetic: what it intersects and what the shapes
// compute from a hit must be the same surface.
#pragma once

#include "math/transform.h"
#include "math/vec.h"
#include "render/shape.h"
#include "render/surface_hit.h"

#include <optional>

namespace abbe {

// Relative error of n float operations: n ε / (1 - n ε) with ε half an ulp [Pharr2023, sec. 6.8.1].
constexpr float gammaBound(int n) {
    const double e = n * 0x1p-24;
    return static_cast<float>(e / (1 - e));
}

// A point p0 + s (p1 - p0) + t (p2 - p0) and a bound on its error per axis. The differences round relative to
// |p0| + |p1|, and every term but p0 carries s or t, hence the weights.
// Written to references and always inlined: by value it cost every hit on a mesh 10 ns of store forwarding.
[[gnu::always_inline]] inline void trianglePoint(const Vec3& p0, const Vec3& p1, const Vec3& p2, float s, float t,
                                                 Vec3& p, Vec3& pError) {
    constexpr float bound = gammaBound(6);
    const auto axis = [s, t](float a, float b, float c, float& x, float& error) {
        x = std::fma(t, c - a, std::fma(s, b - a, a));
        error = bound * std::fma(t, std::abs(c), std::fma(s, std::abs(b), std::abs(a)));
    };
    axis(p0.x, p1.x, p2.x, p.x, pError.x);
    axis(p0.y, p1.y, p2.y, p.y, pError.y);
    axis(p0.z, p1.z, p2.z, p.z, pError.z);
}

// Bound on the error of a point of an analytic shape computed in double and rounded to float: two roundings of the
// result, and some of the magnitudes in double that went into it, which cancel near the origin.
inline Vec3 analyticError(Vec3d p, double magnitude) {
    const Vec3d e = abs(p) * 0x1p-22;
    const double least = magnitude * 0x1p-48;
    return Vec3(e + Vec3d(least, least, least));
}

// Twice the vector area of a triangle, from the two edges that meet opposite the longest one, which loses least on
// slivers (docs/hard_cases.md, case 9).
inline Vec3d triangleCross(Vec3d p0, Vec3d p1, Vec3d p2) {
    const Vec3d e0 = p2 - p1, e1 = p0 - p2, e2 = p1 - p0;
    const double l0 = lengthSquared(e0), l1 = lengthSquared(e1), l2 = lengthSquared(e2);
    if (l0 >= l1 && l0 >= l2) return cross(e1, e2);
    return l1 >= l2 ? cross(e2, e0) : cross(e0, e1);
}

// Of a point in the plane of a triangle: p = p0 + x (p1 - p0) + y (p2 - p0), by least squares. Not finite where the
// triangle is empty.
inline Vec2 barycentrics(Vec3 p, Vec3 p0, Vec3 p1, Vec3 p2) {
    const Vec3d e(p1 - p0), f(p2 - p0), d(p - p0);
    const double ee = dot(e, e), ef = dot(e, f), ff = dot(f, f), ed = dot(e, d), fd = dot(f, d);
    const double scale = 1 / (ee * ff - ef * ef);
    return {static_cast<float>((ff * ed - ef * fd) * scale), static_cast<float>((ee * fd - ef * ed) * scale)};
}

// Solid-angle density at distance² `d2` of a density per area, for the unit normal `ng` and the vector `d` to the
// point; 0 edge-on or at the point itself.
inline float areaToSolidAngle(float pdfArea, Vec3 d, Vec3 ng) {
    const float d2 = lengthSquared(d);
    const float projected = std::abs(dot(d, ng));
    if (!(d2 > 0) || !(projected > 0)) return 0;
    const float pdf = pdfArea * d2 * std::sqrt(d2) / projected;
    return std::isfinite(pdf) ? pdf : 0;
}

// Aᵀ v, for v · A w = (Aᵀ v) · w.
inline Vec3d transposed(const Transform& m, Vec3d v) {
    const auto& a = m.a;
    return {a[0][0] * v.x + a[1][0] * v.y + a[2][0] * v.z, a[0][1] * v.x + a[1][1] * v.y + a[2][1] * v.z,
            a[0][2] * v.x + a[1][2] * v.y + a[2][2] * v.z};
}

// A flat patch where a line meets the plane through `point` with the unit normal `normal`; nothing along the plane.
inline std::optional<SurfacePatch> planarPatch(Vec3d point, Vec3d normal, Vec3d origin, Vec3d direction) {
    const double t = dot(point - origin, normal) / dot(direction, normal);
    if (!std::isfinite(t)) return std::nullopt;
    return SurfacePatch{origin + direction * t, normal, normal, {}, {}};
}

struct StepPosition {
    std::uint32_t step = 0; // and the next one
    float fraction = 0;
};

// Requires at least two steps and a time in [0, 1].
inline StepPosition stepAt(float time, std::size_t steps) {
    const float parts = static_cast<float>(steps - 1), scaled = time * parts;
    const float step = std::clamp(std::floor(scaled), 0.f, parts - 1);
    return {static_cast<std::uint32_t>(step), scaled - step};
}

inline float between(float a, float b, float fraction) { return std::fma(1 - fraction, a, fraction * b); }
inline Vec3 between(Vec3 a, Vec3 b, float fraction) {
    return {between(a.x, b.x, fraction), between(a.y, b.y, fraction), between(a.z, b.z, fraction)};
}
inline SizedPoint between(const SizedPoint& a, const SizedPoint& b, float fraction) {
    return {between(a.position, b.position, fraction), between(a.radius, b.radius, fraction)};
}

} // namespace abbe
