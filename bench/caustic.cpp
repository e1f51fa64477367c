// What finding a caustic from the lamp's side is worth: the ball of scenes/check/ball-caustic.scene, at equal time for
// each way of rendering.
//   bench_caustic [--size N] [--seconds N] [--way 'NAME=PROPERTIES OF RENDER']… [RADIUS…]
//     default: 48, 20, --way 'camera paths=', 0.5 0.1 0.02
// Efficiency is 1 / (relMSE × core-seconds), relMSE the mean of (x - r)² / r² over the pixels of the bright spot, those
// with a tenth and more of the greatest irradiance. (x - r)² is half of the squared difference of two renders of
// different seeds, which knows no bias: r is the quadrature's, and how far the mean of both lies from it stands beside.
#include "ball_spot.h"
#include "base/parallel.h"

#include <cstdio>
#include <cstring>
#include <fmt/format.h>

using namespace abbe;

namespace {

struct Way {
    std::string name, properties;
};

struct Options {
    int size = 48;
    double seconds = 20;
    std::vector<Way> ways;
    std::vector<double> radii;
};

double measure(const Way& way, double radius, const BallSpot& spot, const Options& o) {
    const test::TestScene scene = spot.scene(way.properties);
    const BuiltScene& built = scene.built();
    const MeasuredRender trial = BallSpot::render(built, 64, 7);
    const auto samples = static_cast<std::uint32_t>(std::max(1.0, 64 * o.seconds / trial.statistics.coreSeconds));
    const MeasuredRender a = BallSpot::render(built, samples, 1), b = BallSpot::render(built, samples, 2);
    const double seconds = (a.statistics.coreSeconds + b.statistics.coreSeconds) / 2;
    const BallSpot::Error e = spot.error(a, b);
    const double efficiency = 1 / (e.relMse * seconds);
    std::printf("%6g  %-20s  %8u  %7.2f  %10.3g  %+9.2f %%  %11.3g", radius, way.name.c_str(), samples, seconds,
                e.relMse, 100 * e.deviation, efficiency);
    return efficiency;
}

void run(const Options& o) {
    std::printf("radius  way                    samples        s      relMSE  to quadrature  efficiency  gain\n");
    for (const double radius : o.radii) {
        const BallSpot spot(radius, o.size);
        double first = 0;
        for (const Way& way : o.ways) {
            const double efficiency = measure(way, radius, spot, o);
            if (first == 0) first = efficiency;
            std::printf("  %.3g\n", efficiency / first);
            std::fflush(stdout);
        }
    }
}

Options read(int argc, char** argv) {
    Options o;
    for (int i = 1; i < argc; ++i) {
        const auto next = [&] { return ++i < argc ? argv[i] : ""; };
        if (!std::strcmp(argv[i], "--size"))
            o.size = std::max(1, std::atoi(next()));
        else if (!std::strcmp(argv[i], "--seconds"))
            o.seconds = std::atof(next());
        else if (!std::strcmp(argv[i], "--way")) {
            const std::string text = next();
            const auto at = text.find('=');
            if (at == std::string::npos) throw std::runtime_error("--way 'NAME=PROPERTIES OF RENDER'");
            o.ways.push_back({text.substr(0, at), text.substr(at + 1)});
        } else
            o.radii.push_back(std::atof(argv[i]));
    }
    if (o.ways.empty()) o.ways = {{"camera paths", ""}};
    if (o.radii.empty()) o.radii = {0.5, 0.1, 0.02};
    return o;
}

} // namespace

int main(int argc, char** argv) {
    setThreadCount(1);
    try {
        run(read(argc, argv));
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
