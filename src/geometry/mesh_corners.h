// What still and deforming meshes compute alike from a hit.
#pragma once

#include "math/frame.h"
#include "math/mesh_data.h"
#include "render/shape.h"

namespace abbe {

// Corners of the two triangles of a quad, in Embree's order.
inline constexpr std::array<std::array<std::uint8_t, 3>, 2> kQuadHalves{{{0, 1, 3}, {2, 3, 1}}};

// The triangle, or half of a quad, that was hit.
struct MeshCorners {
    std::uint32_t a, b, c;
    float s, t;           // the point is a + s (b - a) + t (c - a)
    std::uint32_t normal; // of its face: counted over triangles, then two per quad
    std::uint32_t primitive;
};

inline MeshCorners cornersOf(const MeshData& mesh, const RawHit& raw) {
    const auto triangles = static_cast<std::uint32_t>(mesh.triangles.size());
    if (raw.part == 0 && triangles > 0) {
        const auto& [a, b, c] = mesh.triangles[raw.primitive];
        return {a, b, c, raw.u, raw.v, raw.primitive, raw.primitive};
    }
    const bool second = raw.u + raw.v > 1; // Embree's own split
    const auto& quad = mesh.quads[raw.primitive];
    const auto& half = kQuadHalves[second];
    return {quad[half[0]],
            quad[half[1]],
            quad[half[2]],
            second ? 1 - raw.u : raw.u,
            second ? 1 - raw.v : raw.v,
            triangles + 2 * raw.primitive + second,
            triangles + raw.primitive};
}

// As Shape::attribute and Shape::attributeNames.
inline std::optional<Vec3> attributeAt(const MeshData& mesh, std::string_view name, const SurfaceHit& hit) {
    for (const MeshAttribute& a : mesh.attributes) {
        if (a.name != name) continue;
        const MeshCorners c = cornersOf(mesh, {hit.barycentric.x, hit.barycentric.y, 0, hit.element, hit.part});
        const auto at = [&](std::uint32_t vertex) {
            const float* const v = &a.values[static_cast<std::size_t>(vertex) * static_cast<std::size_t>(a.channels)];
            return a.channels == 3 ? Vec3(v[0], v[1], v[2]) : Vec3(v[0], v[0], v[0]);
        };
        return at(c.a) * (1 - c.s - c.t) + at(c.b) * c.s + at(c.c) * c.t;
    }
    return std::nullopt;
}

inline std::vector<std::string_view> attributeNamesOf(const MeshData& mesh) {
    std::vector<std::string_view> names;
    for (const MeshAttribute& a : mesh.attributes) names.push_back(a.name);
    return names;
}

// Not zero, not infinite, not NaN.
inline bool isUsableNormal(Vec3 n) {
    const float l2 = lengthSquared(n);
    return l2 > 0 && l2 < kInfinity;
}

// The frame about `n` whose x follows the first texture coordinate over a triangle with the edges p and coordinates uv
// from its first corner. Parallel or equal uv edges give no direction (docs/hard_cases.md, case 10).
inline Frame texturedFrame(Vec3 n, Vec3 p1, Vec3 p2, Vec2 uv1, Vec2 uv2) {
    // dp/du up to a positive factor.
    const float determinant = uv1.x * uv2.y - uv1.y * uv2.x;
    const float scale = std::max(uv1.x * uv1.x + uv1.y * uv1.y, uv2.x * uv2.x + uv2.y * uv2.y);
    const Vec3 tangent = (p1 * uv2.y - p2 * uv1.y) * std::copysign(1.f, determinant);
    const bool defined = std::abs(determinant) > 1e-6f * scale && isFinite(tangent);
    return defined ? Frame::fromNormalTangent(n, tangent) : Frame::fromNormal(n);
}

// dp/du and dp/dv of such a triangle; left as they are where its coordinates are degenerate.
inline void parametrizeTriangle(Vec3 p1, Vec3 p2, Vec2 uv1, Vec2 uv2, SurfaceHit& hit) {
    const float determinant = uv1.x * uv2.y - uv1.y * uv2.x;
    const float scale = std::max(uv1.x * uv1.x + uv1.y * uv1.y, uv2.x * uv2.x + uv2.y * uv2.y);
    const Vec3 byU = (p1 * uv2.y - p2 * uv1.y) * (1 / determinant), byV = (p2 * uv1.x - p1 * uv2.x) * (1 / determinant);
    if (!(std::abs(determinant) > 1e-6f * scale) || !isFinite(byU) || !isFinite(byV)) return;
    hit.dpdu = byU;
    hit.dpdv = byV;
}

// The same where the mesh has no texture coordinates: uv are those of the face that was hit. A mirrored quad has its
// corners the other way round.
inline void parametrizeFace(const RawHit& raw, Vec3 p1, Vec3 p2, bool quad, bool mirrored, SurfaceHit& hit) {
    const bool second = quad && raw.u + raw.v > 1;
    hit.dpdu = second ? -p1 : p1;
    hit.dpdv = second ? -p2 : p2;
    if (!mirrored) return;
    std::swap(hit.dpdu, hit.dpdv);
    hit.uv = {raw.v, raw.u};
}

} // namespace abbe
