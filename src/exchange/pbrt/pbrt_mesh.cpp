#include "exchange/pbrt/pbrt_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

template <std::size_t N>
void pbrtTurnFaces(std::vector<std::array<std::uint32_t, N>>& faces, const MeshData& mesh, bool reversed) {
    for (auto& face : faces) {
        bool turn = reversed;
        if (!mesh.normals.empty()) {
            const Vec3d a(mesh.positions[face[0]]), b(mesh.positions[face[1]]), c(mesh.positions[face[2]]);
            Vec3d sum;
            for (const std::uint32_t corner : face) sum += Vec3d(mesh.normals[corner]);
            turn = dot(cross(b - a, c - a), sum) < 0;
        }
        if (turn) std::reverse(face.begin() + 1, face.end()); // the first corner stays
    }
}

template <std::size_t N>
void pbrtSplitFaces(std::vector<std::array<std::uint32_t, N>>& faces, const MeshData& from, MeshData& to) {
    constexpr std::array<Vec2, 4> kUvs{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
    for (auto& face : faces)
        for (std::size_t i = 0; i < N; ++i) {
            const std::uint32_t corner = face[i];
            face[i] = static_cast<std::uint32_t>(to.positions.size());
            to.positions.push_back(from.positions[corner]);
            if (!from.normals.empty()) to.normals.push_back(from.normals[corner]);
            to.uvs.push_back(kUvs[i]);
        }
}

template <std::size_t N> bool pbrtInRange(const std::vector<std::array<std::uint32_t, N>>& faces, std::size_t count) {
    return std::ranges::all_of(
        faces, [&](const auto& face) { return std::ranges::all_of(face, [&](auto i) { return i < count; }); });
}

// A net over u and v in [0, 1] of points, normals and coordinates.
template <typename At> MeshData pbrtNet(std::uint32_t across, std::uint32_t along, const At& at) {
    MeshData mesh;
    for (std::uint32_t j = 0; j <= along; ++j)
        for (std::uint32_t i = 0; i <= across; ++i) {
            const double u = static_cast<double>(i) / across, v = static_cast<double>(j) / along;
            const auto [p, n] = at(u, v);
            mesh.positions.emplace_back(p);
            mesh.normals.emplace_back(n);
            mesh.uvs.push_back({static_cast<float>(u), static_cast<float>(v)});
        }
    const std::uint32_t row = across + 1;
    for (std::uint32_t j = 0; j < along; ++j)
        for (std::uint32_t i = 0; i < across; ++i) {
            const std::uint32_t k = j * row + i;
            mesh.quads.push_back({k, k + 1, k + row + 1, k + row});
        }
    return mesh;
}

constexpr std::uint32_t kPbrtAround = 256, kPbrtUp = 128;

} // namespace

void pbrtOrient(MeshData& mesh, bool reversed) {
    if (reversed)
        for (Vec3& n : mesh.normals) n = -n;
    pbrtTurnFaces(mesh.triangles, mesh, reversed);
    pbrtTurnFaces(mesh.quads, mesh, reversed);
}

void pbrtSplitWithUvs(MeshData& mesh) {
    MeshData split;
    pbrtSplitFaces(mesh.triangles, mesh, split);
    pbrtSplitFaces(mesh.quads, mesh, split);
    split.triangles = std::move(mesh.triangles);
    split.quads = std::move(mesh.quads);
    mesh = std::move(split);
}

void pbrtMapUvs(MeshData& mesh, const PbrtUv& map) {
    for (Vec2& uv : mesh.uvs)
        uv = {static_cast<float>(uv.x * map.su + map.du), static_cast<float>(uv.y * map.sv + map.dv)};
}

std::optional<std::string> pbrtMeshFault(const MeshData& mesh) {
    const std::size_t count = mesh.positions.size();
    if (count == 0) return "there are no points `P`";
    if (!mesh.normals.empty() && mesh.normals.size() != count)
        return fmt::format("there are {} normals `N` for {} points", mesh.normals.size(), count);
    if (!mesh.uvs.empty() && mesh.uvs.size() != count)
        return fmt::format("there are {} pairs `uv` for {} points", mesh.uvs.size(), count);
    if (mesh.triangles.empty() && mesh.quads.empty()) return "there are no `indices`";
    if (!pbrtInRange(mesh.triangles, count) || !pbrtInRange(mesh.quads, count))
        return fmt::format("an index is beyond the {} points", count);
    if (!std::ranges::all_of(mesh.positions, [](Vec3 p) { return isFinite(p); }) ||
        !std::ranges::all_of(mesh.normals, [](Vec3 p) { return isFinite(p); }))
        return "a number is too large for single precision";
    return std::nullopt;
}

std::vector<double> pbrtFaceAreas(const MeshData& mesh, const Transform& place) {
    std::vector<double> areas;
    const auto point = [&](std::uint32_t i) { return place.point(Vec3d(mesh.positions[i])); };
    const auto area = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        return length(cross(point(b) - point(a), point(c) - point(a))) / 2;
    };
    for (const auto& t : mesh.triangles) areas.push_back(area(t[0], t[1], t[2]));
    for (const auto& q : mesh.quads) areas.push_back(area(q[0], q[1], q[2]) + area(q[0], q[2], q[3]));
    return areas;
}

MeshData pbrtSphereMesh(const PbrtRound& s) {
    const double first = std::acos(std::clamp(s.zmin / s.radius, -1.0, 1.0));
    const double last = std::acos(std::clamp(s.zmax / s.radius, -1.0, 1.0));
    return pbrtNet(kPbrtAround, kPbrtUp, [&](double u, double v) {
        const double phi = u * s.phimax * kDegree, theta = lerp(first, last, v);
        const Vec3d n{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
        return std::pair(n * s.radius, n);
    });
}

MeshData pbrtCylinderMesh(const PbrtRound& s) {
    return pbrtNet(kPbrtAround, 1, [&](double u, double v) {
        const double phi = u * s.phimax * kDegree;
        const Vec3d n{std::cos(phi), std::sin(phi), 0};
        return std::pair(n * s.radius + Vec3d{0, 0, lerp(s.zmin, s.zmax, v)}, n);
    });
}

// v runs from the rim inwards.
MeshData pbrtDiskMesh(const PbrtRound& s) {
    return pbrtNet(kPbrtAround, 8, [&](double u, double v) {
        const double phi = u * s.phimax * kDegree, r = lerp(s.radius, s.inner, v);
        return std::pair(Vec3d{r * std::cos(phi), r * std::sin(phi), s.zmin}, Vec3d{0, 0, 1});
    });
}

bool pbrtPatches(const MeshData& corners, std::span<const std::uint32_t> indices, MeshData& out) {
    constexpr std::uint32_t kCuts = 8;
    const auto flatness = [&](const std::array<Vec3d, 4>& p) {
        const Vec3d n = cross(p[1] - p[0], p[2] - p[0]);
        return std::abs(dot(n, p[3] - p[0])) <= 1e-6 * length(n) * std::sqrt(lengthSquared(p[3] - p[0]));
    };
    const auto quadOf = [&](std::size_t k) {
        return std::array{indices[k], indices[k + 1], indices[k + 3], indices[k + 2]};
    };
    out = corners;
    bool allFlat = true;
    for (std::size_t k = 0; k + 3 < indices.size(); k += 4) {
        std::array<Vec3d, 4> p;
        for (std::size_t i = 0; i < 4; ++i) p[i] = Vec3d(corners.positions[indices[k + i]]);
        if (flatness(p)) {
            out.quads.push_back(quadOf(k));
            continue;
        }
        allFlat = false;
        const auto blend = [&](const auto& values, double u, double v) {
            using T = std::decay_t<decltype(values[0])>;
            const auto at = [&](std::size_t i) { return values[indices[k + i]]; };
            const auto fu = static_cast<float>(u), fv = static_cast<float>(v);
            return T((at(0) * (1 - fu) + at(1) * fu) * (1 - fv) + (at(2) * (1 - fu) + at(3) * fu) * fv);
        };
        const auto first = static_cast<std::uint32_t>(out.positions.size());
        for (std::uint32_t j = 0; j <= kCuts; ++j)
            for (std::uint32_t i = 0; i <= kCuts; ++i) {
                const double u = static_cast<double>(i) / kCuts, v = static_cast<double>(j) / kCuts;
                out.positions.push_back(blend(corners.positions, u, v));
                if (!corners.normals.empty()) out.normals.push_back(blend(corners.normals, u, v));
                if (!corners.uvs.empty()) out.uvs.push_back(blend(corners.uvs, u, v));
            }
        for (std::uint32_t j = 0; j < kCuts; ++j)
            for (std::uint32_t i = 0; i < kCuts; ++i) {
                const std::uint32_t q = first + j * (kCuts + 1) + i;
                out.quads.push_back({q, q + 1, q + kCuts + 2, q + kCuts + 1});
            }
    }
    return allFlat;
}

} // namespace abbe::exchange
