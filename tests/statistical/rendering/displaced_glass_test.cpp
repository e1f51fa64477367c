// Displacement that overlaps itself (hard case 16): what enters glass must come out again.
#include "support/scene_test.h"
#include "support/scene_test_compare.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

// Clear glass of smooth normals in a white sky is invisible, whatever its form: lossless, and n² cancels. Displaced by
// far more than the radius of its curvature, so that folds run through each other. Shading normals that differ from the
// facets' lose a little light, which finer dicing brings back.
TestScene displacedGlass(double length, int level) {
    return TestScene::parse(fmt::format(
        "scene 1\nfilm {{ size 16 16; filter box 0.5 }}\ncamera {{ from 0 0 4; look-at 0 0 0; fov 30 deg }}\n"
        "light sky {{ radiance 1 }}\n"
        "shape subdivision {{\n"
        "  points {{ - -1 -1 -1; - 1 -1 -1; - -1 1 -1; - 1 1 -1; - -1 -1 1; - 1 -1 1; - -1 1 1; - 1 1 1 }}\n"
        "  faces {{ - 0 2 3 1; - 4 5 7 6; - 0 1 5 4; - 2 6 7 3; - 0 4 6 2; - 1 3 7 5 }}\n"
        "  dicing {}\n  displacement {} {{ map noise {{ scale 0.25; octaves 2 }} }}\n"
        "  material dielectric {{ ior 1.5 }} }}\n",
        level, length));
}

} // namespace

TEST_CASE("displaced glass that overlaps itself transmits all light within one per cent") {
    for (const double length : {0.3, 1.2}) {
        const TestScene scene = displacedGlass(length, length > 1 ? 8 : 7);
        REQUIRE(!scene.diagnostics().hasErrors());
        const TestImage image = render(scene, nightly() ? 1024 : 128);
        double sum = 0;
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 16; ++x) sum += image.film.mean(x, y).y;
        CHECK(std::abs(sum / 256 - 1) < 0.01);
        CHECK(image.statistics.dropped == std::array<std::uint64_t, 3>{});
    }
}

} // namespace abbe::test
