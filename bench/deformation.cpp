// What deformation costs: one mesh standing still and in several time steps. One thread, incoherent rays.
//   deformation [levels of an icosphere, 20 · 4^levels triangles]
//   deformation still: only rays against a room of quads and a still mesh, for counting instructions
#include "bench/measure.h"
#include "geometry/deforming_mesh.h"
#include "geometry/embree_scene_builder.h"
#include "geometry/flat_shapes.h"
#include "geometry/mesh.h"
#include "unit/geometry/test_meshes.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>

using namespace abbe;

namespace {

void measure(const char* name, const Shape& shape, std::size_t triangles, std::size_t own) {
    constexpr int rays = 1'000'000;
    const double before = residentBytes(), start = seconds(CLOCK_PROCESS_CPUTIME_ID);
    EmbreeSceneBuilder builder;
    builder.addShape(shape, {});
    const auto scene = builder.build();
    const double built = seconds(CLOCK_PROCESS_CPUTIME_ID), bvh = residentBytes() - before,
                 count = static_cast<double>(triangles);
    std::vector<Ray> list(rays);
    for (Ray& ray : list) {
        const Vec3 o = normalize(inBall()) * 3;
        ray = {o, normalize(inBall() - o), kInfinity, uniform()};
    }
    SurfaceHit hit;
    int met = 0;
    const double a = seconds(CLOCK_THREAD_CPUTIME_ID);
    for (const Ray& ray : list) met += scene->intersect(ray, hit);
    const double b = seconds(CLOCK_THREAD_CPUTIME_ID);
    for (const Ray& ray : list) met += scene->occluded(ray);
    const double c = seconds(CLOCK_THREAD_CPUTIME_ID);
    std::printf("| %s | %.0f | %.0f | %.2f | %.0f %% | %.2f | %.2f |\n", name, static_cast<double>(own) / count,
                bvh / count, built - start, 50.0 * met / rays, rays / (b - a) / 1e6, rays / (c - b) / 1e6);
    std::fflush(stdout);
}

// Swells and leans, along a curve in `steps` steps.
DeformingMesh deforming(const MeshData& mesh, int steps) {
    std::vector<MeshStep> list;
    for (int k = 0; k < steps; ++k) {
        const float t = static_cast<float>(k) / static_cast<float>(steps - 1);
        MeshStep step;
        for (const Vec3 p : mesh.positions) {
            step.positions.push_back(p * (1 + 0.2f * std::sin(3 * t)) + Vec3(0.3f * t * p.y, 0, 0));
            step.normals.push_back(normalize(p));
        }
        list.push_back(std::move(step));
    }
    return {mesh, std::move(list)};
}

void castStill() {
    MeshData mesh = test::icosphere(4, {}, 0.7);
    for (const Vec3 p : mesh.positions) mesh.normals.push_back(normalize(p));
    const Mesh ball(mesh);
    const Quad floor({-1, -1, 1}, {1, -1, 1}, {1, -1, -1}, {-1, -1, -1}),
        back({-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1});
    EmbreeSceneBuilder builder;
    for (const Shape* shape :
         {static_cast<const Shape*>(&ball), static_cast<const Shape*>(&floor), static_cast<const Shape*>(&back)})
        builder.addShape(*shape, {});
    const auto scene = builder.build();
    int met = 0;
    SurfaceHit hit;
    for (int i = 0; i < 200'000; ++i) {
        const Vec3 o = normalize(inBall()) * 3;
        const Ray ray{o, normalize(inBall() - o), kInfinity, uniform()};
        met += scene->intersect(ray, hit) + scene->occluded(ray);
    }
    std::printf("%d met\n", met);
}

} // namespace

int main(int argc, char** argv) {
    if (argc > 1 && !std::strcmp(argv[1], "still")) return castStill(), 0;
    MeshData mesh = test::icosphere(argc > 1 ? std::atoi(argv[1]) : 7, {}, 1);
    std::printf("| %zu triangles | B/triangle, shape | B/triangle, BVH | build, s | rays that hit | Mrays/s nearest | "
                "Mrays/s any |\n|---|---|---|---|---|---|---|\n",
                mesh.triangles.size());
    for (const Vec3 p : mesh.positions) mesh.normals.push_back(normalize(p));
    const std::size_t vertices = mesh.positions.size(), triangles = mesh.triangles.size();
    for (const int steps : {2, 3, 9, 33}) {
        if (steps == 2) {
            const Mesh still(mesh);
            measure("still", still, triangles, triangles * 24 + vertices * 24);
        }
        const DeformingMesh shape = deforming(mesh, steps);
        measure((std::to_string(steps) + " steps").c_str(), shape, triangles, shape.bytes());
    }
}
