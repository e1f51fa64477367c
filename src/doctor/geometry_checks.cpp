#include "doctor/numeric_check.h"
#include "geometry/embree_scene_builder.h"
#include "geometry/mesh.h"
#include "math/hash.h"
#include "math/warp.h"

namespace abbe::doctor {

namespace {

// Longitudes and latitudes, all vertices on the sphere: convex and closed.
MeshData sphereMesh(std::uint32_t around, std::uint32_t rings, Vec3d centre, double radius) {
    MeshData m;
    const Vec3d pole(0, 0, radius);
    m.positions = {Vec3(centre + pole), Vec3(centre - pole)};
    for (std::uint32_t j = 1; j < rings; ++j)
        for (std::uint32_t i = 0; i < around; ++i) {
            const double theta = kPiD * j / rings, phi = 2 * kPiD * i / around;
            const Vec3d n(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
            m.positions.push_back(Vec3(centre + n * radius));
        }
    const auto vertex = [=](std::uint32_t i, std::uint32_t j) { return 2 + (j - 1) * around + i % around; };
    for (std::uint32_t i = 0; i < around; ++i) {
        m.triangles.push_back({0, vertex(i, 1), vertex(i + 1, 1)});
        m.triangles.push_back({1, vertex(i + 1, rings - 1), vertex(i, rings - 1)});
        for (std::uint32_t j = 1; j + 1 < rings; ++j) {
            m.triangles.push_back({vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1)});
            m.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i + 1, j)});
        }
    }
    return m;
}

Vec3 direction(RandomStream& random) {
    const float u = random.uniform();
    return squareToSphere({u, random.uniform()});
}

// Above the surface; every other one grazes it.
Vec3 leaving(RandomStream& random, Vec3 n, int i) {
    const float cosine = std::max(1e-6f, (i & 1 ? 1e-3f : 1.f) * random.uniform());
    const float sine = std::sqrt(1 - cosine * cosine), phi = 2 * kPi * random.uniform();
    return normalize(Frame::fromNormal(n).toWorld({sine * std::cos(phi), sine * std::sin(phi), cosine}));
}

// The number of rays that escape; `along` 0: aimed at vertices, 1: anywhere on edges.
int escapes(int rays, float along);

std::unique_ptr<Intersector> sceneOf(const Mesh& mesh) {
    EmbreeSceneBuilder builder;
    builder.addShape(mesh, {});
    return builder.build();
}

} // namespace

double selfIntersections(int rays, double offset) {
    // Beyond 1e4 m a facet of a sphere of 1 m is a few roundings wide and the rounded mesh no longer convex.
    const double radius = offset > 1e4 ? 100 : 1;
    const Vec3d centre(offset, 0.7 * offset, -0.3 * offset);
    const Mesh mesh(sphereMesh(256, 64, centre, radius));
    const auto scene = sceneOf(mesh);
    RandomStream random(7);
    int met = 0, again = 0;
    for (int i = 0; i < rays; ++i) {
        const Vec3 origin(centre + Vec3d(direction(random)) * (3 * radius));
        const Vec3d target = centre + Vec3d(direction(random)) * (0.9 * radius);
        SurfaceHit hit;
        const Vec3 d(normalize(target - Vec3d(origin)));
        if (!scene->intersect({origin, d}, hit) || dot(hit.ng, d) >= 0) continue;
        const Vec3 w = leaving(random, hit.ng, i);
        if (dot(w, hit.ng) <= 0) continue;
        ++met;
        again += scene->occluded({spawnOrigin(hit, w), w});
    }
    return met > rays * 9 / 10 ? static_cast<double>(again) / met : 1; // rays that miss prove nothing
}

double escapesAtEdges(int rays) { return escapes(rays, 1); }
double escapesAtVertices(int rays) { return static_cast<double>(escapes(rays, 0)) / rays; }

namespace {

int escapes(int rays, float along) {
    const Vec3d centre(0.3, 0.2, 0.1);
    const Mesh mesh(sphereMesh(128, 64, centre, 1));
    const auto scene = sceneOf(mesh);
    const MeshData& data = mesh.data();
    RandomStream random(2);
    int escaped = 0;
    for (int i = 0; i < rays; ++i) {
        const Vec3 origin = Vec3(centre + Vec3d(direction(random)) * (0.9 * random.uniform()));
        const auto& t = data.triangles[random.bits() % data.triangles.size()];
        const Vec3 a = data.positions[t[i % 3]], b = data.positions[t[(i + 1) % 3]];
        const Vec3 target = a + (b - a) * (along * random.uniform());
        SurfaceHit hit;
        escaped += !scene->intersect({origin, normalize(target - origin)}, hit);
    }
    return escaped;
}

} // namespace

} // namespace abbe::doctor
