// Two estimators agree where the renderer is right and differ where a surface is wrong by a percent.
#include "support/scaled_material.h"
#include "support/scene_test.h"
#include "verify/verify_run.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

const char* const kScenes[] = {
    "scenes/cornell-box/cornell-box.scene",
    "scenes/color-bleeding/color-bleeding.scene",
    "scenes/parametric-shapes/parametric-shapes.scene",
    "scenes/subdivision-still-life/subdivision-still-life.scene",
    "scenes/textures/textures.scene",
    "scenes/shader-ball/shader-ball.scene",
    "scenes/many-lights/many-lights.scene",
    "scenes/veach-mis/veach-mis.scene",
    "scenes/glass-caustic/glass-caustic.scene",
    "scenes/hair-ball/hair-ball.scene",
};

TestScene small(const char* path) {
    BuildOptions options;
    options.size = Vec2i{48, 32};
    return TestScene::load(path, options);
}

VerifyReport run(const TestScene& scene, std::uint64_t seed, std::optional<std::uint32_t> samples = {}) {
    scene.scene(); // without errors
    VerifyPlan plan;
    plan.seed = seed;
    plan.samples = samples;
    return *verify(scene.built(), plan, {});
}

std::string text(const VerifyReport& r) {
    return fmt::format("p {:.2g}, difference {:+.3f} % ± {:.3f} %, unjudged {} of {}, samples {} and {}, {:.1f} s",
                       r.agreement.probability, 100 * r.agreement.whole.difference, 100 * r.agreement.whole.error,
                       r.agreement.unjudged, r.agreement.tiles, r.sides[0].samples, r.sides[1].samples, r.seconds);
}

} // namespace

TEST_CASE("verify: a percent too much in the weights of surfaces is found in ten scenes, and nothing where none is") {
    for (const char* path : kScenes) {
        CAPTURE(path);
        const TestScene sound = small(path);
        const VerifyReport before = run(sound, 1);
        MESSAGE(path << " sound: " << text(before));
        CHECK(before.agreement.agrees());
        CHECK(before.agreement.whole.judged);
        TestScene faulty = small(path);
        scaleMaterials(faulty.changeable(), Scaled::weight, 1.01f);
        const VerifyReport after = run(faulty, 1);
        MESSAGE(path << " weights: " << text(after));
        CHECK(!after.agreement.agrees());
    }
}

} // namespace abbe::test
