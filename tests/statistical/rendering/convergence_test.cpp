// How fast images converge: the slope of the error over the number of samples, from replicates alone.
#include "support/scene_test.h"
#include "support/scene_test_convergence.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

constexpr const char* kSoftShadow = R"(scene 1
film { size 16 16; filter box 0.5 }
camera { from 0 3 5; look-at 0 0.3 0; fov 32 deg }
shape plane { material diffuse { reflectance rgb 0.7 0.6 0.5 } }
shape sphere { center 0 0.6 0; radius 0.5; material diffuse { reflectance 0.5 } }
light quad { points -1 3 -1  1 3 -1  1 3 1  -1 3 1; radiance 3 }
)";

SlopeFit imageSlope(const TestScene& scene, bool random) {
    RenderSettings settings = scene.settings();
    settings.maxDepth = 1;
    settings.technique.numbers = random ? Technique::Numbers::random : Technique::Numbers::sobol;
    return fitSlope(convergence(scene, settings, 16, nightly() ? 4096 : 256));
}

} // namespace

TEST_CASE("convergence of an image: a soft shadow") {
    const auto scene = TestScene::parse(kSoftShadow);
    const SlopeFit random = imageSlope(scene, true), owen = imageSlope(scene, false);
    INFO("slope of RMSE: random " << random.slope << " ± " << random.error << ", Owen-Sobol " << owen.slope << " ± "
                                  << owen.error);
    CHECK(std::abs(random.slope + 0.5) < 0.06);
    CHECK(owen.slope < -0.55);
    // And at the end of the ladder the gain is there.
    RenderSettings settings = scene.settings();
    settings.samples = 8 * 128;
    settings.maxDepth = 1;
    const double sobol = render(scene, settings).film.replicateVariance();
    settings.technique.numbers = Technique::Numbers::random;
    CHECK(render(scene, settings).film.replicateVariance() > 4 * sobol);
}

TEST_CASE("replicates tell the error: their spread is that of the error against the truth") {
    // The pixel means of many short renders scatter about a long one as much as each of them says.
    const auto scene = TestScene::parse(kSoftShadow);
    RenderSettings settings = scene.settings();
    settings.maxDepth = 1;
    settings.samples = 16384;
    const TestImage truth = render(scene, settings);
    double said = 0, found = 0, truthError = 0;
    for (std::uint64_t seed = 10; seed < 26; ++seed) {
        settings.samples = 128;
        settings.seed = seed;
        const TestImage image = render(scene, settings);
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 16; ++x) {
                const Estimate e = image.film.pixel(x, y), t = truth.film.pixel(x, y);
                said += e.variance;
                truthError += t.variance;
                found += square(e.mean - t.mean);
            }
    }
    CHECK(truthError < 0.05 * said);
    CHECK((found - truthError) / said == doctest::Approx(1).epsilon(0.1));
}

} // namespace abbe::test
