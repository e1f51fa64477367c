// What manifold sampling leaves to merging in shipped scenes, by pilots of full size.
#include "caustics/manifold/manifold_sampling.h"
#include "caustics/merging/merge_plan.h"
#include "support/caustics_of.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

CausticFindings planned(const char* file, Technique::Merging merging) {
    const TestScene scene = TestScene::load(file);
    REQUIRE(scene.report() == "");
    RenderSettings settings = scene.settings();
    settings.technique.merging = merging;
    return causticsOf(scene, settings);
}

} // namespace

// Behind the facets of the stone the pilot finds next to nothing.
TEST_CASE("manifold sampling: chains that are hardly ever found are left to merging, if there is any") {
    const CausticFindings both = planned("scenes/diamond/diamond.scene", Technique::Merging::automatic);
    CHECK(both.of<MergeFindings>().used);
    CHECK(both.of<ManifoldFindings>().chains < 8);
    CHECK(both.of<ManifoldFindings>().leftToMerging);
    CHECK_FALSE(both.of<ManifoldFindings>().used);
    const CausticFindings alone = planned("scenes/diamond/diamond.scene", Technique::Merging::off);
    CHECK_FALSE(alone.of<MergeFindings>().used);
    CHECK_FALSE(alone.of<ManifoldFindings>().leftToMerging);
    CHECK(alone.of<ManifoldFindings>().used);
}

TEST_CASE("manifold sampling: chains that are often found stay, beside merging") {
    const CausticFindings both = planned("scenes/mirror-caustic/mirror-caustic.scene", Technique::Merging::automatic);
    CHECK(both.of<MergeFindings>().used);
    CHECK(both.of<ManifoldFindings>().chains > 50);
    CHECK(both.of<ManifoldFindings>().used);
    CHECK_FALSE(both.of<ManifoldFindings>().leftToMerging);
}

} // namespace abbe::test
