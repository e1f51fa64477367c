// Photons where their density has no bound.
#include "caustics/merging/merge_plan.h"
#include "hard_cases/hard_case.h"
#include "support/scene_test.h"

namespace abbe::test {
namespace {

// Under a ball of glass in parallel light, the floor in its paraxial focus: irradiance has no bound there. It is seen
// in a mirror; over an instance no chain is followed, which would have that light.
const char* const kFocus =
    "scene 1\nfilm { size 48 36 }\nrender { max-depth 8 }\n"
    "camera { from 0 0.9 1; look-at 0 0.4 -1; fov 50 deg }\n"
    "shape quad { points -2 0 2  2 0 2  2 0 -2  -2 0 -2; material diffuse { reflectance 0.5 } }\n"
    "shape quad { points -2 0 -0.8  2 0 -0.8  2 2 -0.8  -2 2 -0.8; material conductor { index metal Ag } }\n"
    "object ball { shape sphere { center 0 0.75 0; radius 0.5; material dielectric { ior 1.5 } } }\n"
    "instance ball { }\n"
    "light sun { toward 0 -1 0; angular-diameter 0 deg }\n";

constexpr int kReplicates = 16;

struct Total {
    Moments light;        // of all pixels, by replicate
    double notFinite = 0; // pixels, and dropped samples
};

// `samples`: of a replicate.
Total merged(const TestScene& test, std::uint32_t samples) {
    RenderSettings settings = test.settings();
    settings.samples = samples * kReplicates;
    settings.technique.merging = Technique::Merging::always;
    const TestImage image = renderAsProgram(test, settings, kReplicates);
    CHECK(image.statistics.rounds > 0);
    Total total;
    for (const std::uint64_t dropped : image.statistics.dropped) total.notFinite += static_cast<double>(dropped);
    const PixelBounds b = image.film.bounds();
    for (int r = 0; r < kReplicates; ++r) {
        double light = 0;
        for (int y = b.y0; y < b.y1; ++y)
            for (int x = b.x0; x < b.x1; ++x) {
                const Xyz mean = image.film.pixelFilm().splatMean(SplatKind::merged, x, y, r, r + 1);
                total.notFinite += !std::isfinite(mean.x + mean.y + mean.z) || mean.y < 0;
                light += mean.y;
            }
        total.light.add(light);
    }
    return total;
}

} // namespace

TEST_CASE("case 74: merged photons: no radius, all in one place") {
    HardCase result;
    const TestScene test = TestScene::parse(kFocus);
    const Total few = merged(test, 8), many = merged(test, 64);
    result.measured("pixels that are not finite or negative, and dropped samples, in a focus",
                    few.notFinite + many.notFinite, 0);
    CHECK(many.light.mean() > 0);
    const double error = std::sqrt((few.light.variance() + many.light.variance()) / kReplicates);
    result.measured("what is merged in all, by 8 times as many rounds, in standard errors",
                    std::abs(many.light.mean() - few.light.mean()) / error, 4);
    MESSAGE(few.light.mean() << " " << many.light.mean() << " " << error);
    // Cones of no width: a disk of the least radius, so that density is bounded by photons over its area.
    const double least = 1e-5 * static_cast<double>(test.scene().intersector->bounds().radius());
    result.measured("density of one photon on the least disk is not finite",
                    !std::isfinite(static_cast<float>(2 / (kPiD * least * least))), 0);
    result.naive("density of one photon on a disk without radius", 2 / (kPiD * 0.0));
}

} // namespace abbe::test
