// What finding a caustic from the light's side is worth: the ball of scenes/check/ball-caustic.scene, at equal time for
// each way of rendering.
//   bench_caustic [--size N] [--width METRES] [--least SHARE] [--seconds N] [--way 'NAME=PROPERTIES OF RENDER']…
//                 [RADIUS…]
//     default: 48, 0.6, 0.1, 20, --way 'camera paths=', 0.5 0.1 0.02
// Efficiency is 1 / (relMSE × core-seconds), relMSE the mean of (x - r)² / r² over the pixels of the bright spot, those
// with a tenth (--least) and more of the greatest irradiance. (x - r)² is half of the squared difference of two renders
// of different seeds, which knows no bias: r is the quadrature's, and how far the mean of both lies from it stands
// beside.
#include "ball_spot_options.h"
#include "base/parallel.h"

#include <cstdio>

using namespace abbe;

namespace {

double measure(const BallSpotOptions::Way& way, double radius, const BallSpot& spot, const BallSpotOptions& o) {
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

void run(const BallSpotOptions& o) {
    std::printf("radius  way                    samples        s      relMSE  to quadrature  efficiency  gain\n");
    for (const double radius : o.radii) {
        const BallSpot spot(radius, o.view);
        double first = 0;
        for (const BallSpotOptions::Way& way : o.ways) {
            const double efficiency = measure(way, radius, spot, o);
            if (first == 0) first = efficiency;
            std::printf("  %.3g\n", efficiency / first);
            std::fflush(stdout);
        }
    }
}

} // namespace

int main(int argc, char** argv) {
    setThreadCount(1);
    try {
        run(BallSpotOptions::read(argc, argv, {{}, 20, {{"camera paths", ""}}, {0.5, 0.1, 0.02}}));
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
