// Pilots of path guiding: a glance tells scenes with nothing to guide, and leaves all others to the rounds.
#include "light_sampling/light_sampler.h"
#include "path_tracing/path_kernels.h"
#include "render/render_state.h"
#include "rendering/guide_plan.h"
#include "rendering/look_ahead.h"
#include "support/scene_test.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

// With the smallest pilots, of a square frame.
GuidePlan planOf(const std::string& name, int side, std::uint64_t seed) {
    BuildOptions options;
    options.size = Vec2i{side, side};
    const auto scene = TestScene::load(fmt::format("scenes/{0}/{0}.scene", name), options);
    REQUIRE(scene.report() == "");
    RenderSettings settings = scene.settings();
    settings.seed = seed;
    const LightSampler lights(scene.scene().lights, settings.technique.lightChoice);
    const PathContext context{scene.scene(), lights, settings};
    const RecordingFilm film(scene.built().film, 2);
    const RenderState state(film.bounds(), 0, 0);
    const TileFunction kernel = kernelFor({}).render;
    const auto never = [] { return false; };
    const LookAhead ahead = lookAhead(context, kernel, film, state, never);
    return planGuide(context, kernel, film, ahead.roulette, 1, never);
}

constexpr std::uint64_t kPaths = 2 * 128 * 128; // of the first round, of a frame of 256 × 256 pixels

} // namespace

TEST_CASE("guide: where light comes from all over a glance is enough, nearly always") {
    int looks = 0; // that the first round was made for nothing
    for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
        const GuidePlan plan = planOf("cornell-box", 256, seed);
        CHECK(plan.findings.verdict == GuideFindings::Verdict::noGain);
        CHECK_FALSE(plan.guide);
        CHECK(plan.rays > kPaths / 8); // of several rays each
        looks += plan.rays > kPaths;
    }
    CHECK(looks <= 2);
    // A small frame has its first round at once.
    CHECK(planOf("cornell-box", 64, 1).rays > 2 * kPaths / 16);
}

TEST_CASE("guide: where light comes through a gap the glance leaves it to the rounds") {
    for (const std::uint64_t seed : {1, 2, 3}) {
        const GuidePlan plan = planOf("door-ajar", 256, seed);
        CHECK(plan.findings.verdict == GuideFindings::Verdict::used);
        CHECK(plan.guide);
        CHECK(plan.findings.guided > 0);
    }
}

} // namespace abbe::test
