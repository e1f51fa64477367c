// What it costs to start a path of light, and to find the density of one from its other end: ns for each kind of light
// and number of targets, in one thread.
//   bench_emission [MILLIONS]     default: 1
#include "support/emission_cases.h"

#include <cstdio>
#include <cstdlib>
#include <ctime>

using namespace abbe;

namespace {

double seconds() {
    timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Cost {
    double sample = 0, density = 0; // ns
};

Cost measure(const Scene& scene, int targets, int count) {
    test::Random random(1);
    EmissionPlan plan;
    for (int i = 0; i < targets; ++i) {
        const Vec3 place{random.uniform() - 0.5f, random.uniform() - 0.5f, random.uniform() + 0.5f};
        plan.targets.push_back({place * 2 - Vec3(scene.origin), 0.1f + 0.3f * random.uniform()});
    }
    const AimedEmission emission(scene.lights, scene.intersector->bounds(), plan);
    const Wavelengths lambda = Wavelengths::single(550);
    std::vector<EmissionNumbers> numbers;
    for (int i = 0; i < 1024; ++i) numbers.push_back(test::emissionNumbers(random));
    double sum = 0; // so that nothing is left out
    const double start = seconds();
    for (int i = 0; i < count; ++i) {
        const auto ray = emission.sample(numbers[static_cast<std::size_t>(i % 1024)], lambda, 0.5f);
        if (ray) sum += ray->density.direction;
    }
    const double middle = seconds();
    std::optional<EmittedRay> ray;
    for (const EmissionNumbers& u : numbers)
        if (!ray) ray = emission.sample(u, lambda, 0.5f);
    for (int i = 0; i < count && ray; ++i) {
        const Vec3 p = ray->ray.origin, w = ray->ray.direction;
        sum += ray->density.distant ? emission.density(ray->light, p, w, 0.5f).position
                                    : emission.density(ray->light, ray->part, p, ray->n, w, 0.5f).direction;
    }
    const double end = seconds();
    if (!(sum >= 0)) std::abort();
    return {(middle - start) * 1e9 / count, (end - middle) * 1e9 / count};
}

} // namespace

int main(int argc, char** argv) {
    const int count = 1000000 * (argc > 1 ? std::atoi(argv[1]) : 1);
    std::printf("             ns to start a path, and for its density, with 0, 1, 8 and 64 targets\n");
    for (const test::EmissionCase& emitter : test::emissionCases()) {
        const test::TestScene scene = test::emissionScene(emitter);
        for (const int targets : {0, 1, 8, 64}) {
            const Cost cost = measure(scene.scene(), targets, count);
            std::printf("%6.0f %6.0f   ", cost.sample, cost.density);
        }
        std::printf("%.60s\n", emitter.text.c_str());
        std::fflush(stdout);
    }
}
