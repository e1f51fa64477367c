#include "geometry/mesh_cleanup.h"

#include "geometry/surface_math.h"
#include "math/bounds.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

namespace {

template <typename Faces>
std::optional<std::string> indexError(const Faces& faces, std::size_t vertices, const char* what) {
    for (std::size_t i = 0; i < faces.size(); ++i)
        for (std::uint32_t v : faces[i])
            if (v >= vertices)
                return fmt::format("{} {} refers to vertex {}, but there are {} vertices", what, i, v, vertices);
    return std::nullopt;
}

std::optional<std::string> findError(const MeshData& m) {
    const std::size_t n = m.positions.size();
    if (n > 0xfffffffeu || m.triangles.size() + 2 * m.quads.size() >= 0xffffffffu)
        return "the mesh has more vertices or faces than 32 bits can count";
    if (!m.normals.empty() && m.normals.size() != n)
        return fmt::format("{} normals for {} vertices", m.normals.size(), n);
    if (!m.uvs.empty() && m.uvs.size() != n) return fmt::format("{} uvs for {} vertices", m.uvs.size(), n);
    for (std::size_t i = 0; i < n; ++i)
        if (!isFinite(m.positions[i])) return fmt::format("the position of vertex {} is not finite", i);
    for (std::size_t i = 0; i < m.normals.size(); ++i)
        if (!isFinite(m.normals[i])) return fmt::format("the normal of vertex {} is not finite", i);
    for (std::size_t i = 0; i < m.uvs.size(); ++i)
        if (!isFinite(m.uvs[i].x) || !isFinite(m.uvs[i].y)) return fmt::format("the uv of vertex {} is not finite", i);
    if (auto e = indexError(m.triangles, n, "triangle")) return e;
    return indexError(m.quads, n, "quad");
}

// Erases faces together with their entries in `groups`. Returns how many.
template <typename Face, typename Predicate>
std::size_t eraseFaces(std::vector<Face>& faces, std::vector<std::uint32_t>* groups, const Predicate& unwanted) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < faces.size(); ++i) {
        if (unwanted(i)) continue;
        faces[kept] = faces[i];
        if (groups) (*groups)[kept] = (*groups)[i];
        ++kept;
    }
    const std::size_t erased = faces.size() - kept;
    faces.resize(kept);
    if (groups) groups->resize(kept);
    return erased;
}

// Quads that name one corner twice in a row become triangles; faces with fewer than three corners go.
void removeRepeated(MeshData& m, FaceGroups* groups, MeshCleanup& report) {
    const auto repeated = [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; };
    report.repeatedIndices += eraseFaces(m.triangles, groups ? &groups->triangles : nullptr,
                                         [&](std::size_t i) { return repeated(m.triangles[i]); });
    eraseFaces(m.quads, groups ? &groups->quads : nullptr, [&](std::size_t face) {
        const auto& q = m.quads[face];
        if (q[0] == q[2] || q[1] == q[3]) {
            ++report.repeatedIndices;
            return true;
        }
        for (int i = 0; i < 4; ++i) {
            if (q[i] != q[(i + 1) % 4]) continue;
            const std::array<std::uint32_t, 3> t{q[i], q[(i + 2) % 4], q[(i + 3) % 4]};
            if (repeated(t)) {
                ++report.repeatedIndices;
            } else {
                m.triangles.push_back(t);
                if (groups) groups->triangles.push_back(groups->quads[face]);
                ++report.quadsToTriangles;
            }
            return true;
        }
        return false;
    });
}

} // namespace

MeshCleanup cleanMesh(MeshData& m, FaceGroups* groups) {
    MeshCleanup report;
    report.error = findError(m);
    if (report.error) return report;
    removeRepeated(m, groups, report);

    Bounds3d box;
    for (Vec3 p : m.positions) box.add(Vec3d(p));
    const double diagonal2 = box.empty() ? 0 : lengthSquared(box.diagonal());
    const auto sliver = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        const Vec3d p0(m.positions[a]), p1(m.positions[b]), p2(m.positions[c]);
        const double longest2 = std::max({lengthSquared(p1 - p0), lengthSquared(p2 - p1), lengthSquared(p0 - p2)});
        const double twice = length(triangleCross(p0, p1, p2));
        return !(twice > 1e-6 * longest2) && !(0.5 * twice > 1e-12 * diagonal2);
    };
    report.zeroArea += eraseFaces(m.triangles, groups ? &groups->triangles : nullptr, [&](std::size_t i) {
        const auto& t = m.triangles[i];
        return sliver(t[0], t[1], t[2]);
    });
    report.zeroArea += eraseFaces(m.quads, groups ? &groups->quads : nullptr, [&](std::size_t i) {
        const auto& q = m.quads[i];
        return sliver(q[0], q[1], q[3]) && sliver(q[2], q[3], q[1]);
    });
    return report;
}

} // namespace abbe
