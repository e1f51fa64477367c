// Many instances of one object: instancing [COUNT…]
//   For each count: build time, bytes per instance, peak memory of the process, and rays per second of one thread.
// The object is a lumpy ball of 100,000 triangles; instances stand at random in a square field, turned and scaled, as
// dense at every count. Rays start at random points among them and go in random directions: what paths do after a
// bounce. Each count runs in a process of its own, so that peaks do not mix.
#include "base/parallel.h"
#include "geometry/embree_scene_builder.h"
#include "geometry/mesh.h"
#include "math/hash.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>
#include <sys/wait.h>
#include <unistd.h>

using namespace abbe;

namespace {

class Random {
  public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    float uniform() { return unitFloat(static_cast<std::uint32_t>(mix64(++state_) >> 32)); }
    Vec3 direction() {
        for (;;) {
            const Vec3 v(2 * uniform() - 1, 2 * uniform() - 1, 2 * uniform() - 1);
            if (const float l2 = lengthSquared(v); l2 > 1e-6f && l2 <= 1) return v * (1 / std::sqrt(l2));
        }
    }

  private:
    std::uint64_t state_;
};

constexpr std::uint32_t kAround = 316, kRings = 159; // 2 · 316 · 158 triangles

MeshData lumpyBall() {
    MeshData m;
    for (std::uint32_t j = 0; j <= kRings; ++j)
        for (std::uint32_t i = 0; i < kAround; ++i) {
            const double theta = kPiD * j / kRings, phi = 2 * kPiD * i / kAround;
            const double r = 0.4 + 0.04 * std::sin(9 * phi) * std::sin(7 * theta) * std::sin(theta);
            m.positions.push_back(
                Vec3(Vec3d(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)) * r));
        }
    for (std::uint32_t j = 0; j < kRings; ++j)
        for (std::uint32_t i = 0; i < kAround; ++i) {
            const std::uint32_t next = (i + 1) % kAround;
            const std::uint32_t a = j * kAround + i, b = a + kAround, c = b - i + next, d = c - kAround;
            if (j + 1 < kRings) m.triangles.push_back({a, c, b});
            if (j > 0) m.triangles.push_back({a, d, c});
        }
    m.positions.reserve(m.positions.size() + 2);
    return m;
}

// From /proc: VmRSS or VmHWM in bytes.
double memory(const char* which) {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with(which)) return 1024 * std::atof(line.c_str() + line.find(':') + 1);
    return 0;
}

double threadSeconds() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

Transform placed(Random& random, double side) {
    const double size = 0.5 + static_cast<double>(random.uniform());
    const double x = side * static_cast<double>(random.uniform()), z = side * static_cast<double>(random.uniform());
    return Transform::rotate(Vec3d(random.direction()), 6.0 * static_cast<double>(random.uniform()))
        .then(Transform::scale({size, size * 0.8, size}))
        .then(Transform::translate({x, 0, z}));
}

void measureRays(const Intersector& scene, float side) {
    constexpr int rays = 1000000;
    for (const bool shadow : {false, true}) {
        Random random(7);
        int hits = 0;
        const double start = threadSeconds();
        for (int i = 0; i < rays; ++i) {
            const Vec3 origin(side * random.uniform(), 2 * random.uniform() - 1, side * random.uniform());
            const Ray ray{origin, random.direction()};
            SurfaceHit hit;
            hits += shadow ? scene.occluded(ray) : scene.intersect(ray, hit);
        }
        const double seconds = threadSeconds() - start;
        std::printf(" %9.3f", 1e-6 * rays / seconds);
        if (shadow) std::printf(" %7.1f%%", 100.0 * hits / rays);
    }
}

void measure(std::size_t count) {
    const Mesh mesh(lumpyBall());
    {
        EmbreeSceneBuilder alone; // so that the object's own memory is not counted
        alone.addInstance(alone.addObject({{&mesh, {}}}), Transform());
        alone.build();
    }
    const double before = memory("VmRSS"), side = std::sqrt(static_cast<double>(count));
    EmbreeSceneBuilder builder;
    const std::uint32_t object = builder.addObject({{&mesh, {}}});
    Random random(1);
    std::vector<Placement> placements;
    placements.reserve(count);
    for (std::size_t i = 0; i < count; ++i) placements.emplace_back(placed(random, side));
    builder.addInstances(object, std::move(placements));
    const auto start = std::chrono::steady_clock::now();
    const auto scene = builder.build();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::printf("%9zu %9.3f %10.0f %9.1f", count, seconds, (memory("VmRSS") - before) / static_cast<double>(count),
                memory("VmHWM") / 1048576);
    measureRays(*scene, static_cast<float>(side));
    std::printf("\n");
}

} // namespace

int main(int argc, char** argv) {
    setThreadCount(2);
    std::vector<std::size_t> counts;
    for (int i = 1; i < argc; ++i) counts.push_back(std::strtoull(argv[i], nullptr, 10));
    if (counts.empty()) counts = {1000, 10000, 100000, 1000000, 10000000};
    std::printf("    count   build s   bytes/in  peak MiB   Mray/s Mshadow/s    hits\n");
    for (const std::size_t count : counts) {
        std::fflush(stdout);
        if (const pid_t child = fork(); child == 0) {
            measure(count);
            std::fflush(stdout);
            _exit(0);
        } else {
            waitpid(child, nullptr, 0);
        }
    }
}
