#include "geometry/mesh_cleanup.h"
#include "io/gltf.h"
#include "scene/file_faults.h"
#include "scene/shape_types.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

namespace {

// glTF states metres and y up; other formats say nothing and are taken as the scene's own.
void toScene(MeshFile& file, double unit, bool zUp) {
    const bool stated = file.coordinates == MeshCoordinates::metresYUp;
    const bool turn = stated && zUp;
    for (Vec3& p : file.mesh.positions) {
        if (turn) p = {p.x, -p.z, p.y};
        if (!stated) p = Vec3(Vec3d(p) * unit);
    }
    if (turn)
        for (Vec3& n : file.mesh.normals) n = {n.x, -n.z, n.y};
}

// The number of its group for every face.
FaceGroups groupsOf(MeshFile& file) {
    FaceGroups result;
    result.triangles.resize(file.mesh.triangles.size());
    result.quads.resize(file.mesh.quads.size());
    for (MeshGroup& group : file.groups) {
        const auto number = static_cast<std::uint32_t>(result.names.size());
        std::fill_n(result.triangles.begin() + static_cast<std::ptrdiff_t>(group.firstTriangle), group.triangleCount,
                    number);
        std::fill_n(result.quads.begin() + static_cast<std::ptrdiff_t>(group.firstQuad), group.quadCount, number);
        result.names.push_back(std::move(group.name));
    }
    return result;
}

std::optional<MeshData> fromFile(const schema::Text& file, double unit, bool zUp, FaceGroups* groups, Span span,
                                 Diagnostics& diagnostics) {
    std::optional<MeshData> mesh;
    readsFile(file.value, file.span.valid() ? file.span : span, diagnostics, [&] {
        GltfSelection selection;
        for (const auto& [key, value] : file.keys) (key == "node" ? selection.node : selection.mesh) = value;
        MeshFile read = file.keys.empty() ? readMesh(file.value) : readGltf(file.value, selection);
        toScene(read, unit, zUp);
        if (groups) *groups = groupsOf(read);
        mesh = std::move(read.mesh);
    });
    return mesh;
}

std::optional<MeshData> fromRows(const std::vector<Vec3d>& points, const schema::IndexRows& faces, Span span,
                                 Diagnostics& diagnostics) {
    MeshData mesh;
    mesh.positions.reserve(points.size());
    for (Vec3d p : points) mesh.positions.push_back(Vec3(p));
    const std::span<const std::uint32_t> all(faces.indices);
    std::size_t first = 0;
    for (std::size_t face = 0; face < faces.counts.size(); ++face) {
        const std::span<const std::uint32_t> corners = all.subspan(first, faces.counts[face]);
        first += corners.size();
        for (const std::uint32_t index : corners)
            if (index >= points.size()) {
                diagnostics.error(
                    "E0611", span,
                    fmt::format("face {} names vertex {}, but there are {} points", face, index, points.size()),
                    "counted from 0");
                return std::nullopt;
            }
        if (corners.size() < 3 || !addPolygon(mesh, corners)) {
            diagnostics.error("E0611", span,
                              fmt::format("face {} is no polygon that can be split into triangles", face),
                              fmt::format("{} corners", corners.size()));
            return std::nullopt;
        }
    }
    return mesh;
}

} // namespace

Vec3d farMiddle(const std::vector<Vec3d>& points) {
    if (points.empty()) return {};
    Vec3d lower = points[0], upper = points[0];
    for (const Vec3d p : points) lower = min(lower, p), upper = max(upper, p);
    const Vec3d middle = (lower + upper) * 0.5;
    constexpr double far = 64; // sizes of the mesh: six bits less for its details
    const bool isFar = maxComponent(abs(middle)) > far * maxComponent(upper - lower);
    return isFar && isFinite(middle) ? middle : Vec3d();
}

std::vector<Vec3d> relativeTo(Vec3d origin, std::vector<Vec3d> points) {
    for (Vec3d& p : points) p = p - origin;
    return points;
}

std::optional<MeshData> statedMesh(const schema::Text& file, double unit, const std::vector<Vec3d>& points,
                                   const schema::IndexRows& faces, Span span, Diagnostics& diagnostics, bool zUp,
                                   FaceGroups* groups) {
    auto mesh = file.value.empty() ? fromRows(points, faces, span, diagnostics)
                                   : fromFile(file, unit, zUp, groups, span, diagnostics);
    if (mesh && groups) { // what is written in place has none
        groups->triangles.resize(mesh->triangles.size());
        groups->quads.resize(mesh->quads.size());
    }
    return mesh;
}

std::optional<MeshData> loadMesh(const schema::Text& file, double unit, const std::vector<Vec3d>& points,
                                 const schema::IndexRows& faces, Span span, Diagnostics& diagnostics, bool zUp,
                                 FaceGroups* groups) {
    auto mesh = statedMesh(file, unit, points, faces, span, diagnostics, zUp, groups);
    if (!mesh) return std::nullopt;
    const MeshCleanup cleanup = cleanMesh(*mesh, groups);
    if (cleanup.error) {
        diagnostics.error("E0611", span, *cleanup.error, "damaged mesh");
        return std::nullopt;
    }
    if (mesh->triangles.empty() && mesh->quads.empty()) {
        diagnostics.error("E0604", span, "this mesh has no faces with an area", "nothing to see here");
        return std::nullopt;
    }
    if (cleanup.removed() > 0)
        diagnostics.warning("W0603", span, fmt::format("{} faces without area are left out", cleanup.removed()));
    return mesh;
}

} // namespace abbe
