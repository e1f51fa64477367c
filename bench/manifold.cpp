// What one estimate by specular manifold sampling costs and is worth, beside paths that find the light by chance.
//   bench_manifold [ESTIMATES]     default: 20000
//   for each scene and point: µs, rays, trials and Newton steps of an estimate; relative variances of the estimate and
//   of the path beside it, which has what the estimate leaves out; the efficiency 1 / (relative variance × s) of both
//   together, that of paths alone, and the ratio. Paths are aimed at the casters and cost nothing but their rays.
#include "support/manifold_walk.h"

#include <chrono>
#include <cstdlib>
#include <fmt/format.h>

using namespace abbe;
using namespace abbe::test;

namespace {

struct Row {
    const char* name;
    std::string scene;
    Vec3 p;
};

std::string ballUnderLight(double radius) {
    return fmt::format("shape sphere {{ center 0 1.6 0; radius 1; material dielectric {{ ior 1.5 }} }}\n"
                       "light sphere {{ center 1.5 7 0; radius {}; radiance 1 }}\n",
                       radius);
}

double seconds(auto&& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// One estimate and one path, which brings the light that the estimate leaves out, together.
void measure(const Row& row, float largestImage, bool learnt, int estimates) {
    ManifoldCase test(row.scene, largestImage);
    if (learnt) test.learn(row.p, 400);
    ManifoldMean m;
    const double n = estimates, time = seconds([&] { m = test.all(row.p, estimates); }) / n;
    const int paths = 20 * estimates;
    Moments covered, rest;
    const double walking = seconds([&] { covered = walkTo(test, row.p, paths, false, Found::covered); }) / paths;
    rest = walkTo(test, row.p, paths, false, Found::others);
    const double mean = m.value.mean() + rest.mean();
    const double own = square(mean) / ((m.value.variance() + rest.variance()) * (time + walking));
    // Both parts in one path: no path brings both.
    const double both = covered.variance() + rest.variance() - 2 * covered.mean() * rest.mean();
    const double other = square(covered.mean() + rest.mean()) / (both * walking);
    fmt::print(
        "{:26} image < {:<5} {:7} {:6.1f} us {:6.1f} rays {:5.2f} trials {:6.2f} steps; covered {:5.1f} %; relative "
        "variance {:7.1f} + {:7.1f}; efficiency {:9.3g}; paths alone {}; {} capped\n",
        row.name, largestImage, learnt ? "learnt" : "", 1e6 * time, static_cast<double>(m.counts.rays) / n,
        static_cast<double>(m.counts.trials) / n, static_cast<double>(m.counts.iterations) / n,
        100 * m.value.mean() / mean, m.value.variance() / square(mean), rest.variance() / square(mean), own,
        both > 0 ? fmt::format("{:.3g}, {:.3g} times", other, own / other) : "found nothing", m.counts.capped);
}

} // namespace

int main(int argc, char** argv) {
    const int estimates = argc > 1 ? std::atoi(argv[1]) : 20000;
    const std::string ring =
        "shape torus { major-radius 1; minor-radius 0.3; transform { translate 0 0.6 0 }; material "
        "dielectric { ior 1.5 } }\nlight sphere { center 1 6 0; radius 0.05; radiance 1 }\n";
    const Row rows[] = {
        {"ball, light 0.5, focus", ballUnderLight(0.5), {-0.45f, 0, 0}},
        {"ball, light 0.1, focus", ballUnderLight(0.1), {-0.45f, 0, 0}},
        {"ball, light 0.02, focus", ballUnderLight(0.02), {-0.45f, 0, 0}},
        {"ball, light 0.5, beside", ballUnderLight(0.5), {-0.3f, 0, 0.2f}},
        {"ball, light 0.1, beside", ballUnderLight(0.1), {-0.3f, 0, 0.2f}},
        {"ball, light 0.02, beside", ballUnderLight(0.02), {-0.3f, 0, 0.2f}},
        {"ring of glass, light 0.05", ring, {-0.6f, 0, 0.2f}},
        {"pool, sun of 0.53 deg",
         "shape plane { material dielectric { ior 1.33 } }\nlight sun { elevation 40 deg; radiance 1 }\n",
         {0, -1, 0}},
        {"mirror, light 0.05",
         "shape quad { size 2 2; transform { rotate y 180 deg; translate 0 0 2 }; material conductor { index metal Ag "
         "} "
         "}\nlight sphere { center 1 0.5 0; radius 0.05; radiance 1 }\n",
         {0, 0, 0}},
    };
    for (const Row& row : rows)
        for (const float image : {kInfinity, 0.5f})
            for (const bool learnt : {false, true}) measure(row, image, learnt, estimates);
    return 0;
}
