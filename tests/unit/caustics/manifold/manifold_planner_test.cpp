// What manifold sampling leaves to merging.
#include "caustics/manifold/manifold_planner.h"
#include "support/light_plan.h"
#include "support/manifold_cases.h"

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

// A plan of a ball of glass and two lamps, in which kind TRT is one that a pilot hardly saw; beside merging of the
// light of the first lamps.
class BesideMerging {
  public:
    explicit BesideMerging(std::size_t mergedLamps, bool onlyRare = false)
        : test_("shape ball sphere { material dielectric { ior 1.5 } }\n"
                "light sphere { center 3 0 0; radius 0.1; radiance 1 }\n"
                "light sphere { center 0 3 0; radius 0.1; radiance 1 }\n") {
        REQUIRE(test_.ok());
        const Scene& scene = test_.scene.scene();
        ManifoldPlan plan = planOfAll(scene, 0.5f);
        if (onlyRare) plan.casters.at(0).weights.fill(0);
        plan.casters.at(0).weights[kRare] = ManifoldPilot::kLeastWeight;
        planned_.findings.used = true;
        planned_.findings.chains = 1000;
        planned_.sampler = std::make_unique<const ManifoldSampler>(scene, std::move(plan));
        std::unordered_set<const Light*> merged;
        for (std::size_t i = 0; i < mergedLamps; ++i) merged.insert(scene.lights.at(i).get());
        planned_.besideMerging(scene, merged);
    }
    const PlannedManifold& planned() const { return planned_; }
    float rare() const { return planned_.sampler->plan().casters.at(0).weights[kRare]; }
    float frequent() const { return planned_.sampler->plan().casters.at(0).weights[ChainSignature::of("TT").index()]; }
    float largestImage(std::size_t lamp) const { return planned_.sampler->plan().lights.at(lamp).largestImage; }

  private:
    static inline const std::size_t kRare = ChainSignature::of("TRT").index();
    ManifoldCase test_;
    PlannedManifold planned_;
};

} // namespace

TEST_CASE("manifold sampling: a kind of chain that the pilot hardly saw is left to merging, the others stay") {
    const BesideMerging both(2);
    REQUIRE(both.planned().sampler);
    CHECK(both.rare() == 0);
    CHECK(both.frequent() > 0.1f);
    CHECK(both.largestImage(0) == 0.02f);
    CHECK(both.largestImage(1) == 0.02f);
}

// Nobody else would find them: the light of the second lamp is not merged.
TEST_CASE("manifold sampling: rare kinds stay where a lamp's light is not merged") {
    const BesideMerging one(1);
    REQUIRE(one.planned().sampler);
    CHECK(one.rare() == ManifoldPilot::kLeastWeight);
    CHECK(one.frequent() > 0.1f);
    CHECK(one.largestImage(0) == 0.02f);
    CHECK(one.largestImage(1) == 0.5f);
}

TEST_CASE("manifold sampling: none is left where all kinds are rare and all light is merged") {
    const BesideMerging rare(2, true);
    CHECK_FALSE(rare.planned().sampler);
    CHECK(rare.planned().findings.leftToMerging);
    CHECK_FALSE(rare.planned().findings.used);
}

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
