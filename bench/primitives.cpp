// Bytes per primitive and rays per second of curves and points, one thread, incoherent rays.
//   primitives [points, in thousands] [hairs, in thousands]
#include "bench/measure.h"
#include "geometry/curves.h"
#include "geometry/embree_scene_builder.h"
#include "geometry/points.h"

#include <cstdio>
#include <cstdlib>
#include <sys/wait.h>
#include <unistd.h>

using namespace abbe;

namespace {

constexpr int kRays = 200'000;
constexpr int kSegments = 10;

void measure(const char* name, const Shape& shape, std::size_t primitives, std::size_t own) {
    const double before = residentBytes(), start = seconds(CLOCK_PROCESS_CPUTIME_ID);
    EmbreeSceneBuilder builder;
    builder.addShape(shape, {});
    const auto scene = builder.build();
    const double built = seconds(CLOCK_PROCESS_CPUTIME_ID), bvh = residentBytes() - before,
                 count = static_cast<double>(primitives);
    std::vector<Ray> rays(kRays);
    for (Ray& ray : rays) {
        const Vec3 o = normalize(inBall()) * 3;
        ray = {o, normalize(inBall() - o)};
    }
    int met = 0;
    SurfaceHit hit;
    const double a = seconds(CLOCK_THREAD_CPUTIME_ID);
    for (const Ray& ray : rays) met += scene->intersect(ray, hit);
    const double b = seconds(CLOCK_THREAD_CPUTIME_ID);
    int hidden = 0;
    for (const Ray& ray : rays) hidden += scene->occluded(ray);
    const double c = seconds(CLOCK_THREAD_CPUTIME_ID);
    std::printf("| %s | %.0f | %.0f | %.2f | %.0f %% | %.2f | %.2f |\n", name, static_cast<double>(own) / count,
                bvh / count, built - start, 100.0 * met / kRays, kRays / (b - a) / 1e6, kRays / (c - b) / 1e6);
    std::fflush(stdout);
    if (met != hidden) std::fprintf(stderr, "%s: %d rays met, %d hidden\n", name, met, hidden);
}

void points(const char* name, PointForm form, int count) {
    PointData data{form, {}, {}};
    const float radius = 0.3f / std::cbrt(static_cast<float>(count));
    for (int i = 0; i < count; ++i) {
        data.points.push_back({inBall(), radius});
        if (form == PointForm::orientedDisk) data.normals.push_back(normalize(inBall()));
    }
    const Points shape(std::move(data));
    measure(name, shape, shape.count(), shape.bytes());
}

// Hairs that stand on a ball and wave.
void hairs(const char* name, CurveBasis basis, CurveForm form, int count) {
    CurveData data{basis, form, {}, {}};
    const std::uint32_t size = leastPoints(basis) + (kSegments - 1) * pointStep(basis);
    const float step = 0.5f / static_cast<float>(size);
    for (int i = 0; i < count; ++i) {
        Vec3 d = normalize(inBall()), p = d * 0.5f;
        for (std::uint32_t k = 0; k < size; ++k) {
            data.points.push_back({p, 0.0008f * (1 - 0.8f * static_cast<float>(k) / static_cast<float>(size))});
            d = normalize(d + inBall() * 0.3f);
            p += d * step;
        }
        data.strandSizes.push_back(size);
    }
    const Curves shape(std::move(data));
    measure(name, shape, shape.segmentCount(), shape.bytes());
}

// Each kind in a process of its own, so that none inherits the memory of the one before.
template <typename F> void apart(const F& run) {
    const pid_t child = fork();
    if (child == 0) {
        run();
        std::fflush(nullptr);
        _exit(0);
    }
    if (child > 0) waitpid(child, nullptr, 0);
}

} // namespace

int main(int argc, char** argv) {
    const int pointCount = 1000 * (argc > 1 ? std::atoi(argv[1]) : 1000);
    const int hairCount = 1000 * (argc > 2 ? std::atoi(argv[2]) : 100);
    std::printf("| kind | own bytes | BVH bytes | build, CPU s | rays that hit | nearest, M/s | any, M/s |\n"
                "|---|---|---|---|---|---|---|\n");
    std::fflush(stdout);
    apart([&] { points("spheres", PointForm::sphere, pointCount); });
    apart([&] { points("disks to the ray", PointForm::disk, pointCount); });
    apart([&] { points("disks with normals", PointForm::orientedDisk, pointCount); });
    const std::pair<const char*, CurveBasis> bases[] = {{"linear", CurveBasis::linear},
                                                        {"B-spline", CurveBasis::bspline},
                                                        {"Catmull-Rom", CurveBasis::catmullRom},
                                                        {"Bézier", CurveBasis::bezier}};
    for (const auto& [name, basis] : bases)
        for (const CurveForm form : {CurveForm::round, CurveForm::flat}) {
            const std::string text = std::string(form == CurveForm::round ? "round " : "flat ") + name;
            apart([&] { hairs(text.c_str(), basis, form, hairCount); });
        }
}
