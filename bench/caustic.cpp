// What finding a caustic from the lamp's side is worth: the ball of scenes/check/ball-caustic.scene, at equal time for
// each way of rendering.
//   bench_caustic [--size N] [--seconds N] [--way 'NAME=PROPERTIES OF RENDER']… [RADIUS…]
//     default: 48, 20, --way 'camera paths=', 0.5 0.1 0.02
// Efficiency is 1 / (relMSE × core-seconds), relMSE the mean of (x - r)² / r² over the pixels of the bright spot, those
// with a tenth and more of the greatest irradiance. (x - r)² is half of the squared difference of two renders of
// different seeds, which knows no bias: r is the quadrature's, and how far the mean of both lies from it stands beside.
#include "base/parallel.h"
#include "render_error.h"
#include "support/ball_caustic_profile.h"
#include "support/scene_test.h"

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

constexpr double kHalfWidth = 0.3, kReflectance = 0.5;

// The floor ends where the picture does, so that little comes back to it by the ball: some 1 % at this reflectance.
constexpr const char* kScene = R"(scene 1
film {{ size {0} {0}; filter box 0.5 }}
camera orthographic {{ from 0 0.2 0; look-at 0 0 0; up 0 0 -1; width 0.6 }}
render {{ replicates 1; {1} }}
shape sphere {{ center 0 1.3 0; radius 1; material dielectric {{ ior 1.5 }} }}
shape quad {{ size 0.6 0.6; material diffuse {{ reflectance {2} }}; transform {{ rotate x -90 deg }} }}
light disk {{ center 0 5.8 0; normal 0 -1 0; radius {3}; radiance 1 }}
)";

MeasuredRender render(const BuiltScene& built, std::uint32_t samples, std::uint64_t seed) {
    RenderSettings how = renderSettings(built.render);
    how.samples = samples;
    how.seed = seed;
    return measuredRender(built, how, 1);
}

// Radiance of each pixel, Y; light falls alike on all sides of the axis.
std::vector<double> reference(double lampRadius, int size) {
    test::BallCausticScene scene;
    scene.lampRadius = lampRadius;
    const double pixel = 2 * kHalfWidth / size;
    const test::BallCausticProfile profile(test::BallCaustic(scene), 1.5 * kHalfWidth, pixel, 1e-3);
    std::vector<double> result;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const double x0 = -kHalfWidth + x * pixel, z0 = -kHalfWidth + y * pixel;
            result.push_back(kReflectance / kPiD * profile.mean(x0, x0 + pixel, z0, z0 + pixel, 2));
        }
    return result;
}

struct SpotError {
    double relMse = 0, deviation = 0; // of the mean of both
};

// The light is flat, so that R + G + B goes with Y.
SpotError spotError(const MeasuredRender& a, const MeasuredRender& b, const std::vector<double>& exact) {
    const double least = 0.1 * *std::max_element(exact.begin(), exact.end());
    const Vec3d white = toRgb(Xyz{1, 1, 1}, rgb::rec709);
    double squares = 0, found = 0, there = 0, pixels = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        if (exact[i] < least) continue;
        const auto value = [&](const MeasuredRender& m) { return m.rgb[3 * i + 1] / white.y; };
        squares += 0.5 * square((value(a) - value(b)) / exact[i]);
        found += (value(a) + value(b)) / 2;
        there += exact[i];
        ++pixels;
    }
    return {squares / pixels, found / there - 1};
}

double measure(const Way& way, double radius, const std::vector<double>& exact, const Options& o) {
    const auto scene = test::TestScene::parse(fmt::format(kScene, o.size, way.properties, kReflectance, radius));
    if (scene.diagnostics().hasErrors()) throw std::runtime_error(scene.report());
    const BuiltScene& built = scene.built();
    const MeasuredRender trial = render(built, 64, 7);
    const auto samples = static_cast<std::uint32_t>(std::max(1.0, 64 * o.seconds / trial.statistics.coreSeconds));
    const MeasuredRender a = render(built, samples, 1), b = render(built, samples, 2);
    const double seconds = (a.statistics.coreSeconds + b.statistics.coreSeconds) / 2;
    const SpotError e = spotError(a, b, exact);
    const double efficiency = 1 / (e.relMse * seconds);
    std::printf("%6g  %-20s  %8u  %7.2f  %10.3g  %+9.2f %%  %11.3g", radius, way.name.c_str(), samples, seconds,
                e.relMse, 100 * e.deviation, efficiency);
    return efficiency;
}

void run(const Options& o) {
    std::printf("radius  way                    samples        s      relMSE  to quadrature  efficiency  gain\n");
    for (const double radius : o.radii) {
        const auto exact = reference(radius, o.size);
        double first = 0;
        for (const Way& way : o.ways) {
            const double efficiency = measure(way, radius, exact, o);
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
