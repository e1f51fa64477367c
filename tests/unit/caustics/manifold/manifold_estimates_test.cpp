// Several estimates by manifold sampling at one vertex: each counts its share.
#include "caustics/light_tracing/light_path_plan.h"
#include "caustics/manifold/manifold_sampler.h"
#include "caustics/shared/aimed_emission.h"
#include "film/pixel_film.h"
#include "light_sampling/light_sampler.h"
#include "path_tracing/path_kernels.h"
#include "support/manifold_cases.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

constexpr int kWidth = 16, kHeight = 12;
constexpr std::uint32_t kEstimateSamples = 64;

class Sum final : public ManifoldListener {
  public:
    explicit Sum(const Scene& scene) : scene_(scene) {}
    void sampled(const ChainStart&, const Spectrum&, const Wavelengths& lambda, const Spectrum& light,
                 const Spectrum&) override {
        const double y = scene_.sensor(light, lambda).y;
        sum += y;
        ++calls;
        with += y > 0;
    }
    double sum = 0;
    std::uint64_t calls = 0, with = 0;

  private:
    const Scene& scene_;
};

// Σ of all samples, and what their estimates came to one by one.
struct Told {
    double picture = 0, estimates = 0;
    std::uint64_t calls = 0, with = 0;
};

Told renderedWith(std::uint32_t estimates, const TestScene& test) {
    const Scene& scene = test.scene();
    ManifoldPlan plan = planOfAll(scene, 0.5f);
    plan.estimates = estimates;
    const ManifoldSampler sampler(scene, std::move(plan));
    const RenderSettings settings = test.settings();
    const LightSampler lights(scene.lights, settings.technique.lightChoice);
    const LightPathPlan none{AimedEmission(scene.lights, scene.intersector->bounds(), {}), 0, false, 1};
    PathContext context{scene, lights, settings, true, 1, LoopTechnique(settings.technique), &none, &sampler};
    Sum heard(scene);
    context.manifoldListener = &heard;
    PixelFilm film({0, 0, kWidth, kHeight}, {FilterShape::box, 0.5}, 1);
    const RouletteReference roulette = RouletteReference::constant(1);
    kernelFor(kLoopEffects).lightPaths.render(context, film, {film.bounds(), 0, kEstimateSamples, &roulette});
    Told told{0, heard.sum, heard.calls, heard.with};
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) told.picture += film.mean(x, y).y * kEstimateSamples;
    return told;
}

} // namespace

// Estimates have numbers of their own, so that paths are the same however many there are: what is left of the picture
// without them is the same, too.
TEST_CASE("manifold sampling: of several estimates at a vertex their mean counts") {
    const TestScene scene =
        TestScene::parse("scene 1\nfilm { size 16 12; filter box 0.5 }\nrender { max-depth 8 }\n"
                         "camera { from 0 2.3 3.5; look-at -0.3 0.6 -1.5; fov 24 deg }\n"
                         "shape quad { points -6 0 6  6 0 6  6 0 -6  -6 0 -6; material diffuse { reflectance 0.5 } }\n"
                         "shape sphere { center -0.35 0.9 -0.3; radius 0.45; material dielectric { ior 1.5 } }\n"
                         "shape quad { points -2 0 -1.5  2 0 -1.5  2 2 -1.5  -2 2 -1.5; material conductor { index "
                         "metal Ag } }\n"
                         "light sphere { center -1.5 5 -1; radius 0.2; radiance 100 }\n");
    REQUIRE(scene.report() == "");
    const Told one = renderedWith(1, scene), five = renderedWith(5, scene);
    CHECK(one.with > 50);
    CHECK(five.calls == 5 * one.calls);
    CHECK(five.with > 4 * one.with);
    const double rest = one.picture - one.estimates;
    CHECK(rest > 0);
    CHECK(one.estimates > 0.01 * one.picture);
    CHECK(five.picture - five.estimates / 5 == doctest::Approx(rest).epsilon(1e-5));
}

} // namespace abbe::test
