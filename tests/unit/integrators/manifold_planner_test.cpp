// What manifold sampling leaves to merging.
#include "support/light_plan.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

LightPathFindings planned(const char* file, Technique::Merging merging) {
    const TestScene scene = TestScene::load(file);
    REQUIRE(scene.report() == "");
    RenderSettings settings = scene.settings();
    settings.technique.merging = merging;
    return lightPlanOf(scene, settings);
}

} // namespace

// Behind the facets of the stone the pilot finds next to nothing.
TEST_CASE("manifold sampling: chains that are hardly ever found are left to merging, if there is any") {
    const LightPathFindings both = planned("scenes/diamond/diamond.scene", Technique::Merging::automatic);
    CHECK(both.merging.used);
    CHECK(both.manifold.chains < 8);
    CHECK(both.manifold.leftToMerging);
    CHECK_FALSE(both.manifold.used);
    const LightPathFindings alone = planned("scenes/diamond/diamond.scene", Technique::Merging::off);
    CHECK_FALSE(alone.merging.used);
    CHECK_FALSE(alone.manifold.leftToMerging);
    CHECK(alone.manifold.used);
}

TEST_CASE("manifold sampling: chains that are often found stay, beside merging") {
    const LightPathFindings both = planned("scenes/mirror-caustic/mirror-caustic.scene", Technique::Merging::automatic);
    CHECK(both.merging.used);
    CHECK(both.manifold.chains > 50);
    CHECK(both.manifold.used);
    CHECK_FALSE(both.manifold.leftToMerging);
}

} // namespace abbe::test
