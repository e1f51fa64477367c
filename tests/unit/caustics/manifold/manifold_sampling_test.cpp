// What manifold sampling leaves to merging.
#include "caustics/manifold/manifold_sampling.h"
#include "caustics/merging/merge_plan.h"
#include "support/manifold_cases.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

// A plan of a ball of glass and two lights, in which kind TRT is one that a pilot hardly saw; beside merging of the
// light of the first lights.
class BesideMerging {
  public:
    explicit BesideMerging(std::size_t mergedLights, bool onlyRare = false)
        : test_("shape ball sphere { material dielectric { ior 1.5 } }\n"
                "light sphere { center 3 0 0; radius 0.1; radiance 1 }\n"
                "light sphere { center 0 3 0; radius 0.1; radiance 1 }\n") {
        REQUIRE(test_.ok());
        const Scene& scene = test_.scene.scene();
        ManifoldPlan plan = planOfAll(scene, 0.5f);
        if (onlyRare) plan.casters.at(0).weights.fill(0);
        plan.casters.at(0).weights[kRare] = ManifoldPilot::kLeastWeight;
        PlannedManifold pilots;
        pilots.findings.used = true;
        pilots.findings.chains = 1000;
        pilots.sampler = std::make_unique<const ManifoldSampler>(scene, std::move(plan));
        technique_ = ManifoldSampling(std::move(pilots));
        LightSet merged;
        for (std::size_t i = 0; i < mergedLights; ++i) merged.insert(scene.lights.at(i).get());
        technique_.leave(scene, merged);
    }
    const PlannedManifold& planned() const { return technique_.planned(); }
    float rare() const { return planned().sampler->plan().casters.at(0).weights[kRare]; }
    float frequent() const {
        return planned().sampler->plan().casters.at(0).weights[ManifoldKinds::indexOf(ChainSignature::of("TT"))];
    }
    float largestImage(std::size_t light) const { return planned().sampler->plan().lights.at(light).largestImage; }

  private:
    static inline const std::size_t kRare = ManifoldKinds::indexOf(ChainSignature::of("TRT"));
    ManifoldCase test_;
    ManifoldSampling technique_;
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

// Nobody else would find them: the light of the second light is not merged.
TEST_CASE("manifold sampling: rare kinds stay where a light's light is not merged") {
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

} // namespace abbe::test
