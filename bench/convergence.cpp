// How the error of a scene falls with the number of samples, for random numbers and for Owen-scrambled Sobol points.
//   convergence [SCENE [WIDTHxHEIGHT [LARGEST]]]
// Prints relative errors for 8 … LARGEST samples per pixel (default 512) and the slope of their logarithms, from eight
// replicates of every number of samples; no reference image is needed. Without SCENE: a soft shadow.
#include "support/scene_test_convergence.h"

#include <charconv>
#include <cstdio>
#include <fmt/format.h>

namespace {

using namespace abbe;
using namespace abbe::test;

constexpr const char* kSoftShadow = R"(scene 1
film { size 64 64 }
camera { from 0 3 5; look-at 0 0.3 0; fov 32 deg }
shape plane { material diffuse { reflectance rgb 0.7 0.6 0.5 } }
shape sphere { center 0 0.6 0; radius 0.5; material diffuse { reflectance 0.5 } }
light quad { points -1 3 -1  1 3 -1  1 3 1  -1 3 1; radiance 3 }
)";

constexpr int kReplicates = 8;

struct Ladder {
    std::vector<RatePoint> points;
    SlopeFit fit;
};
Ladder ladder(const TestScene& scene, bool random, std::uint32_t largest) {
    RenderSettings settings = scene.settings();
    settings.technique.numbers = random ? Technique::Numbers::random : Technique::Numbers::sobol;
    Ladder result{convergence(scene, settings, 8, largest, kReplicates), {}};
    result.fit = fitSlope(result.points);
    return result;
}

int run(int argc, char** argv) {
    BuildOptions options;
    int width = 0, height = 0;
    if (argc > 2 && std::sscanf(argv[2], "%dx%d", &width, &height) == 2) options.size = Vec2i{width, height};
    std::uint32_t largest = 512;
    if (argc > 3) std::from_chars(argv[3], argv[3] + std::string_view(argv[3]).size(), largest);
    const auto scene = argc > 1 ? TestScene::load(std::filesystem::absolute(argv[1]), options)
                                : TestScene::parse(kSoftShadow, options);
    if (scene.diagnostics().hasErrors()) {
        fmt::print(stderr, "{}", scene.report());
        return 1;
    }
    const double level = render(scene, 64).film.image().mean;
    const Ladder random = ladder(scene, true, largest), owen = ladder(scene, false, largest);
    fmt::print("{:>8}  {:>12}  {:>12}  {:>8}\n", "samples", "random", "Owen-Sobol", "MSE gain");
    for (std::size_t i = 0; i < random.points.size(); ++i) {
        const RatePoint &r = random.points[i], &o = owen.points[i];
        fmt::print("{:>8}  {:>10.4f} %  {:>10.4f} %  {:>8.2f}\n", r.samples, 100 * std::sqrt(r.mse) / level,
                   100 * std::sqrt(o.mse) / level, r.mse / o.mse);
    }
    fmt::print("slope of RMSE: random {:.3f} ± {:.3f}, Owen-Sobol {:.3f} ± {:.3f} (95 %)\n", random.fit.slope,
               1.96 * random.fit.error, owen.fit.slope, 1.96 * owen.fit.error);
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::exception& e) {
        fmt::print(stderr, "{}\n", e.what());
        return 1;
    }
}
