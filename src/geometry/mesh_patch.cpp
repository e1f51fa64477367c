#include "geometry/mesh.h"
#include "geometry/mesh_corners.h"
#include "geometry/surface_math.h"

namespace abbe {

namespace {

// Where a line meets the plane of a triangle with the edges e1 and e2 from `corner`, and by how much that is outside.
struct PlanePoint {
    double s = 0, t = 0, outside = std::numeric_limits<double>::infinity();
    Vec3d p;
};

PlanePoint meet(Vec3d corner, Vec3d e1, Vec3d e2, Vec3d origin, Vec3d direction) {
    const Vec3d across = cross(e1, e2);
    const double area2 = lengthSquared(across), distance = dot(corner - origin, across) / dot(direction, across);
    if (!(area2 > 0) || !std::isfinite(distance)) return {};
    PlanePoint q;
    q.p = origin + direction * distance;
    const Vec3d d = q.p - corner;
    q.s = dot(d, cross(e2, across)) / area2;
    q.t = dot(d, cross(across, e1)) / area2;
    q.outside = std::max(std::max(-q.s, -q.t), std::max(q.s + q.t - 1, 0.0));
    return q;
}

} // namespace

std::optional<SurfacePatch> Mesh::patch(const SurfaceHit& hit, Vec3d origin, Vec3d direction) const noexcept {
    const auto& p = data_.positions;
    const auto [first, count] = trianglesOf(hit.primitive);
    std::uint64_t chosen = first;
    PlanePoint at;
    for (std::uint64_t i = first; i < first + static_cast<std::uint64_t>(count); ++i) {
        const auto [a, b, c] = triangle(i);
        const PlanePoint q = meet(Vec3d(p[a]), Vec3d(p[b]) - Vec3d(p[a]), Vec3d(p[c]) - Vec3d(p[a]), origin, direction);
        if (q.outside < at.outside) at = q, chosen = i;
    }
    if (!std::isfinite(at.outside)) return std::nullopt;
    const auto [a, b, c] = triangle(chosen);
    const Vec3d e1 = Vec3d(p[b]) - Vec3d(p[a]), e2 = Vec3d(p[c]) - Vec3d(p[a]), across = cross(e1, e2);
    const Vec3d ng = normalize(across);
    SurfacePatch patch{at.p, ng, ng, {}, {}};
    if (data_.normals.empty()) return patch;
    // As shade(): linear over the triangle, then made unit.
    const Vec3d n0(data_.normals[a]), d1 = Vec3d(data_.normals[b]) - n0, d2 = Vec3d(data_.normals[c]) - n0;
    const Vec3d n = n0 + d1 * at.s + d2 * at.t;
    if (!isUsableNormal(Vec3(n))) return patch;
    const double area2 = lengthSquared(across), scale = (dot(n, ng) < 0 ? -1 : 1) / length(n);
    patch.n = n * scale;
    patch.along = {cross(e2, across) / area2, cross(across, e1) / area2};
    patch.change = {(d1 - patch.n * dot(d1, patch.n)) * scale, (d2 - patch.n * dot(d2, patch.n)) * scale};
    return patch;
}

} // namespace abbe
