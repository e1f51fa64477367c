// Paths from the lights give the picture that paths from the camera give.
#include "caustics/light_tracing/light_path.h"
#include "caustics/manifold/manifold_plan.h"
#include "caustics/shared/aimed_emission.h"
#include "path_tracing/path_kernels.h"
#include "support/scene_test.h"
#include "verify/agreement.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

constexpr int kLoopReplicates = 32, kWidth = 32, kHeight = 24;
constexpr EffectBits kBits = (kLoopEffects | Effect::lightPaths).bits();

PixelFilter box() { return {FilterShape::box, 0.5}; }

// How much of the picture each of the two ways brings.
struct Parts {
    TileSums both, camera, light;
};

// What light paths bring, sums over their number, is kept beside what camera paths bring.
class TwoWays {
  public:
    TwoWays(const TestScene& test, EmissionPlan plan, double share, bool alone, float afterSpread = 1)
        : scene_(test.scene()), settings_(test.settings()), lights_(scene_.lights, settings_.technique.lightChoice),
          plan_{AimedEmission(scene_.lights, scene_.intersector->bounds(), std::move(plan)),
                static_cast<std::uint32_t>(share * kWidth * kHeight), alone, afterSpread},
          context_{scene_, lights_, settings_, true, 1, LoopTechnique(settings_.technique), &plan_} {}

    Parts run(std::uint32_t samples) {
        context_.settings.seed = 11;
        const auto light = traceLight(samples * plan_.paths);
        PixelFilm camera({0, 0, kWidth, kHeight}, box(), kLoopReplicates);
        const RouletteReference roulette = RouletteReference::constant(1);
        kernelFor(kLoopEffects).lightPaths.render(context_, camera, {{0, 0, kWidth, kHeight}, 0, samples, &roulette});
        PixelFilm both({0, 0, kWidth, kHeight}, box(), kLoopReplicates),
            alone({0, 0, kWidth, kHeight}, box(), kLoopReplicates);
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x)
                for (int r = 0; r < kLoopReplicates; ++r) {
                    const Xyz s = light[static_cast<std::size_t>((y * kWidth + x) * kLoopReplicates + r)];
                    alone.add(x, y, r, ExactXyz(s), 1);
                    both.add(x, y, r, ExactXyz(s + camera.mean(x, y, r, r + 1)), 1);
                }
        return {TileSums(both), TileSums(camera), TileSums(alone)};
    }

  private:
    std::vector<Xyz> traceLight(std::uint32_t paths) {
        std::vector<Xyz> sums(static_cast<std::size_t>(kWidth * kHeight * kLoopReplicates));
        auto media = PathWalk<kBits>::makeMedia(scene_);
        PathCounters counters;
        Sampler sampler;
        Arena arena;
        VertexArenas vertexArenas;
        for (int r = 0; r < kLoopReplicates; ++r) {
            sampler.startPixel(combine64(77, static_cast<std::uint64_t>(r)), Technique::Numbers::sobol, true);
            for (std::uint32_t i = 0; i < paths; ++i) {
                sampler.start(i);
                const VertexSample n = sampler.vertex(0);
                const Wavelengths lambda = scene_.wavelengths.sample(sampler.wavelength());
                const float time = scene_.camera->rayTime(sampler.time());
                const auto start = plan_.emission.sample(
                    {static_cast<double>(n.pick), static_cast<double>(sampler.film().x), n.lobe, n.light, n.bsdf},
                    lambda, time);
                if (!start) continue;
                LightPath<kBits> path(context_, sampler, arena, vertexArenas, counters, media);
                path.trace(*start, lambda, [&](const LensSplat& s) {
                    const int x = static_cast<int>(std::floor(s.film.x)), y = static_cast<int>(std::floor(s.film.y));
                    if (x < 0 || y < 0 || x >= kWidth || y >= kHeight) return;
                    Xyz& sum = sums[static_cast<std::size_t>((y * kWidth + x) * kLoopReplicates + r)];
                    sum += scene_.sensor(s.value, lambda) * (1.0 / paths);
                });
            }
        }
        return sums;
    }

    const Scene& scene_;
    RenderSettings settings_;
    LightSampler lights_;
    LightPathPlan plan_;
    PathContext context_;
};

TileSums seen(const TestScene& test, std::uint32_t samples, std::uint64_t seed = 5,
              Technique::LightPaths lightPaths = Technique::LightPaths::off, ManifoldFindings* manifold = nullptr) {
    PixelFilm film({0, 0, kWidth, kHeight}, box(), kLoopReplicates);
    RenderSettings settings = test.settings();
    settings.technique.lightPaths = lightPaths;
    if (lightPaths != Technique::LightPaths::off) film.keepSplats();
    settings.samples = samples * kLoopReplicates;
    settings.seed = seed;
    const auto statistics = makePathTracer(test.scene().effects)->render(test.scene(), film, settings, {});
    if (manifold) *manifold = statistics.caustics.of<ManifoldFindings>();
    return TileSums(film);
}

void check(const std::string& name, const TileSums& expected, const TileSums& found, double error) {
    const Agreement a = compare(expected, found, 1e-3);
    INFO(name);
    MESSAGE(fmt::format("{}: p {:.2g}, {:+.3f} ± {:.3f} %, unjudged {} of {}", name, a.probability,
                        100 * a.whole.difference, 100 * a.whole.error, a.unjudged, a.tiles));
    CHECK(a.agrees());
    CHECK(a.whole.judged);
    CHECK(a.whole.error < error);
}

double total(const TileSums& sums) {
    double y = 0;
    for (const auto& replicate : sums.whole().replicates) y += replicate[1];
    return y;
}

// Camera paths alone against light paths that bring all they can, and against both together.
void compareBoth(const std::string& name, const std::string& text, std::uint32_t samples, std::uint32_t plain,
                 const EmissionPlan& plan = {}, double share = 1, float afterSpread = 1) {
    const TestScene scene =
        TestScene::parse("scene 1\nfilm { size 32 24; filter box 0.5 }\nrender { max-depth 8 }\n" + text);
    const TileSums expected = seen(scene, plain);
    check(name + ", alone", expected, TwoWays(scene, plan, share, true, afterSpread).run(samples).both, 0.02);
    const Parts weighed = TwoWays(scene, plan, share, false, afterSpread).run(samples);
    check(name + ", both", expected, weighed.both, 0.01);
    MESSAGE(fmt::format("light paths bring {:.3g} of it", total(weighed.light) / total(weighed.both)));
}

// Finite: what has no end may lie before the place where light from far away starts.
const char* const kLoopFloor =
    "shape quad { points { - -6 0 6; - 6 0 6; - 6 0 -6; - -6 0 -6 }; material diffuse { reflectance 0.5 } }\n";

} // namespace

TEST_CASE("light paths: matte and glossy surfaces, lights of several kinds") {
    const std::string camera = "camera { from 0 2.2 4; look-at 0 0.2 0; fov 34 deg }\n";
    const std::string things =
        std::string(kLoopFloor) +
        "shape sphere { center -0.7 0.5 0; radius 0.5; material diffuse { reflectance rgb 0.7 0.3 0.2 } }\n"
        "shape sphere { center 0.7 0.5 0; radius 0.5; material conductor { index metal Au; roughness 0.5 } }\n";
    compareBoth("sphere lamp", camera + things + "light sphere { center -1 4 1; radius 0.4; radiance 10 }\n", 24, 48);
    compareBoth("point", camera + things + "light point { position 1 3 1; power 100 W }\n", 24, 48);
    compareBoth("sky", camera + things + "light sky { radiance 1 }\n", 96, 96);
}

TEST_CASE("light paths: caustics of glass and of glass that disperses") {
    // The ball is seen, too, with the light in it.
    const std::string camera = "camera { from 0 2.3 3.5; look-at 0 0.8 0; fov 34 deg }\n";
    const std::string floor = kLoopFloor;
    const std::string emitter = "light sphere { center -1.5 5 -1; radius 0.8; radiance 10 }\n";
    EmissionPlan plan;
    plan.targets = {{{-0.35f, 1.8f - 2.3f, -0.3f - 3.5f}, 0.46f}}; // render space has its origin at the camera
    for (const char* ior : {"1.5", "glass SF11"})
        compareBoth(
            ior,
            camera + floor + emitter +
                fmt::format("shape sphere {{ center -0.35 1.8 -0.3; radius 0.45; material dielectric {{ ior {} }} }}\n",
                            ior),
            24, 200, plan);
}

TEST_CASE("light paths: parts of a target, and fewer after light is spread") {
    EmissionPlan plan;
    plan.targets = {{{-0.35f, 1.8f - 2.3f, -0.3f - 3.5f}, 0.46f}};
    plan.aim = {1};
    plan.parts.resize(1);
    for (int i = 0; i < 64; ++i) plan.parts[0].push_back(i % 8 < 3 || i / 8 == 4 ? 4 : 0.5);
    const std::string scene = "camera { from 0 2.3 3.5; look-at 0 0.8 0; fov 34 deg }\n" + std::string(kLoopFloor) +
                              "shape sphere { center -0.35 1.8 -0.3; radius 0.45; material dielectric { ior 1.5 } }\n"
                              "shape sphere { center 0.7 0.5 0; radius 0.5; material diffuse { reflectance 0.7 } }\n";
    compareBoth("lamp, parts", scene + "light sphere { center -1.5 5 -1; radius 0.8; radiance 10 }\n", 24, 200, plan, 1,
                0.4f);
    compareBoth("sun, parts", scene + "light sun { toward 0.3 -1 0.2; angular-diameter 20 deg }\n", 24, 200, plan, 1,
                0.4f);
}

TEST_CASE("light paths: fog") {
    compareBoth("fog",
                "camera { from 0 1 4; look-at 0 0.8 0; fov 34 deg }\n" + std::string(kLoopFloor) +
                    "light sphere { center -1 4 1; radius 0.4; radiance 20 }\n"
                    "shape sphere { center 0 1 0; radius 0.9; material boundary\n"
                    "    interior homogeneous { extinction table 400 2.2 700 0.8 per-m; albedo 0.9; phase "
                    "henyey-greenstein 0.5 } }\n",
                24, 96);
}

// A caustic in a mirror, and one seen through the ball that makes it: manifold sampling and what it leaves to chance.
TEST_CASE("light paths: caustics in mirrors and through glass, by manifold sampling") {
    const auto sceneOf = [](const std::string& view, const std::string& ior, const std::string& emitter) {
        return TestScene::parse("scene 1\nfilm { size 32 24; filter box 0.5 }\nrender { max-depth 8 }\n"
                                "camera { from 0 2.3 3.5; " +
                                view + " }\n" + kLoopFloor +
                                "shape ball sphere { center -0.35 0.9 -0.3; radius 0.45; material dielectric { ior " +
                                ior +
                                " } }\n"
                                "shape mirror quad { points { - -2 0 -1.5; - 2 0 -1.5; - 2 2 -1.5; - -2 2 -1.5 };"
                                " material conductor { index metal Ag } }\n"
                                "light sphere { center -1.5 5 -1; " +
                                emitter + " }\n");
    };
    constexpr std::uint64_t kSeed = 7;
    const std::string wide = "look-at 0 0.6 0; fov 40 deg", narrow = "look-at -0.3 0.6 -1.5; fov 24 deg";
    for (const char* ior : {"1.5", "glass SF11"}) {
        const TestScene scene = sceneOf(wide, ior, "radius 0.5; radiance 10");
        const bool sparks = std::string(ior) != "1.5"; // what the hero alone brings, of which one may be most of 64
        check(std::string(ior) + ", manifolds", seen(scene, 300, kSeed),
              seen(scene, sparks ? 160 : 64, kSeed, Technique::LightPaths::always), 0.02);
    }
    if (!nightly()) return; // fewer than 1200 samples miss rare light
    // Where little else is seen several estimates for each vertex are worth it.
    const TestScene scene = sceneOf(narrow, "1.5", "radius 0.2; radiance 100");
    ManifoldFindings manifold;
    const TileSums found = seen(scene, 64, kSeed, Technique::LightPaths::always, &manifold);
    CHECK(manifold.estimates > 1);
    check(fmt::format("{} estimates", manifold.estimates), seen(scene, 1200, kSeed), found, 0.02);
}

} // namespace abbe::test
