// Meshes that several tests need.
#pragma once

#include "math/mesh_data.h"
#include "math/transform.h"

#include <cmath>
#include <map>

namespace abbe::test {

// A sphere of longitudes and latitudes with its vertices on the sphere: convex. 2 · around · (rings - 1) triangles.
inline MeshData uvSphere(int around, int rings, Vec3d centre, double radius) {
    MeshData m;
    for (int j = 0; j <= rings; ++j)
        for (int i = 0; i < around; ++i) {
            const double theta = kPiD * j / rings, phi = 2 * kPiD * i / around;
            const Vec3d n(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
            m.positions.push_back(Vec3(centre + n * radius));
        }
    const auto vertex = [around](int i, int j) { return static_cast<std::uint32_t>(j * around + i % around); };
    for (int j = 0; j < rings; ++j)
        for (int i = 0; i < around; ++i) {
            const std::uint32_t a = vertex(i, j), b = vertex(i, j + 1), c = vertex(i + 1, j + 1), d = vertex(i + 1, j);
            if (j < rings - 1) m.triangles.push_back({a, b, c});
            if (j > 0) m.triangles.push_back({a, c, d});
        }
    return m;
}

// An icosahedron subdivided `levels` times: closed, 20 · 4^levels triangles.
inline MeshData icosphere(int levels, Vec3d centre, double radius) {
    const double g = (1 + std::sqrt(5.0)) / 2;
    std::vector<Vec3d> p{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                         {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    std::vector<std::array<std::uint32_t, 3>> t{{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                                {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                                {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                                {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [it, fresh] =
                middles.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<std::uint32_t>(p.size()));
            if (fresh) p.push_back((p[a] + p[b]) * 0.5);
            return it->second;
        };
        std::vector<std::array<std::uint32_t, 3>> finer;
        for (const auto& [a, b, c] : t) {
            const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
        }
        t = std::move(finer);
        for (Vec3d& q : p) q = normalize(q);
    }
    MeshData m;
    for (Vec3d q : p) m.positions.push_back(Vec3(centre + normalize(q) * radius));
    m.triangles = std::move(t);
    return m;
}

// A cube of quads, outward.
inline MeshData cube(Vec3 lower, Vec3 upper) {
    MeshData m;
    for (int i = 0; i < 8; ++i)
        m.positions.push_back({i & 1 ? upper.x : lower.x, i & 2 ? upper.y : lower.y, i & 4 ? upper.z : lower.z});
    m.quads = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    return m;
}

// The mesh with its vertices moved; windings turned under mirrors, so that outside stays outside.
inline MeshData moved(MeshData m, const Transform& t) {
    for (Vec3& p : m.positions) p = Vec3(t.point(Vec3d(p)));
    for (Vec3& n : m.normals) n = Vec3(t.normal(Vec3d(n))); // lengths kept in proportion: they weigh the blend
    if (t.determinant() < 0) {
        for (auto& f : m.triangles) std::swap(f[1], f[2]);
        for (auto& q : m.quads) std::swap(q[1], q[3]);
    }
    return m;
}

} // namespace abbe::test
