// A list of techniques for caustics: whose turn it is in a block, what they tell, and what their rays come to.
#include "caustics/shared/pilot.h"
#include "light_sampling/light_sampler.h"
#include "rendering/caustic_plans.h"
#include "support/scene_test.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

struct FakeFindings {
    int value = 7;
};

// Does units of a block up to the one that it is told to stop at, counts them as rounds and notes where it began.
class FakeTechnique final : public CausticTechnique {
  public:
    bool blocks = true;
    std::optional<std::uint32_t> stopsAt;
    mutable std::vector<PortionPlace> begun;

    void plan(const PilotInput&) override {}
    bool used() const override { return blocks; }
    void giveTo(PathContext&) const override {}
    std::optional<TileResult> render(const PathContext&, const LightPathKernel&, Film& film,
                                     const BlockJob& job) const override {
        if (!blocks) return std::nullopt;
        TileResult result;
        const std::uint32_t units = job.units(film);
        if (job.from.unit >= units) return result;
        begun.push_back(job.from);
        const std::uint32_t end = stopsAt.value_or(units);
        result.rounds = end - job.from.unit;
        if (stopsAt) result.rest = PortionPlace{end, 5};
        return result;
    }
    void report(CausticFindings& to) const override { to.of<FakeFindings>().value = 3; }
    Rays rays() const override { return {10, 0.25}; }
};

// The first and the last of three have work in blocks, of three samples of two replicates.
struct FakePlans {
    FakeTechnique *first, *second, *third;
    CausticPlans plans;

    FakePlans() {
        std::vector<std::unique_ptr<CausticTechnique>> list;
        for (FakeTechnique** const place : {&first, &second, &third}) {
            auto technique = std::make_unique<FakeTechnique>();
            *place = technique.get();
            list.push_back(std::move(technique));
        }
        second->blocks = false;
        plans = CausticPlans(std::move(list));
    }
    TileResult render(PortionPlace from) const {
        const TestScene test = TestScene::parse("scene 1\ncamera { from 0 0 5; look-at 0 0 0 }\nlight sky { luminance 1 nits }\n");
        const LightSampler lights(test.scene().lights);
        PilotPixel film({0, 0, 1, 1}, 2);
        return plans.render({test.scene(), lights, {}}, {}, film, {4, 7, 0, 1, from});
    }
};

} // namespace

TEST_CASE("caustic plans: units of a technique follow those of the one before it") {
    const FakePlans fake;
    const TileResult whole = fake.render({});
    CHECK(whole.rounds == 12);
    CHECK_FALSE(whole.rest);
    REQUIRE(fake.first->begun.size() == 1);
    REQUIRE(fake.third->begun.size() == 1);
    CHECK(fake.third->begun[0].unit == 0);
}

TEST_CASE("caustic plans: a block goes on where it was cut short, with the technique that was at work") {
    const FakePlans fake;
    fake.first->stopsAt = 2;
    const TileResult cut = fake.render({});
    CHECK(cut.rounds == 2);
    REQUIRE(cut.rest);
    CHECK(cut.rest->unit == 2);
    CHECK(fake.third->begun.empty()); // waits for its turn
    fake.first->stopsAt.reset();
    fake.third->stopsAt = 1;
    const TileResult later = fake.render(*cut.rest);
    CHECK(later.rounds == 4 + 1);
    REQUIRE(later.rest);
    CHECK(later.rest->unit == 6 + 1);
    CHECK(fake.first->begun.back().done == 5);
    CHECK(fake.third->begun.back().unit == 0);
    CHECK(fake.third->begun.back().done == 0);
    fake.third->stopsAt.reset();
    const TileResult last = fake.render(*later.rest);
    CHECK(last.rounds == 5);
    CHECK_FALSE(last.rest);
    CHECK(fake.first->begun.size() == 2); // has done all of its own
    CHECK(fake.third->begun.back().unit == 1);
    CHECK(fake.third->begun.back().done == 5);
}

TEST_CASE("caustic plans: rays and findings are those of all techniques") {
    const FakePlans fake;
    CHECK(fake.plans.any());
    CHECK(fake.plans.pilotRays() == 30);
    CHECK(fake.plans.raysOfSample(2) == kCostBesideLightPaths * 2 + 0.75);
    CHECK(fake.plans.findings().of<FakeFindings>().value == 3);
    CHECK(CausticPlans().raysOfSample(2) == 2);
    CHECK_FALSE(CausticPlans().any());
}

TEST_CASE("caustic findings: a record of each type, as it is by default where nobody told it") {
    struct Others {
        int value = 1;
    };
    CausticFindings findings;
    CHECK(std::as_const(findings).of<FakeFindings>().value == 7);
    auto& record = findings.of<FakeFindings>();
    record.value = 8;
    findings.of<Others>().value = 2; // which leaves the first where it is
    const CausticFindings copy = findings;
    record.value = 9;
    CHECK(std::as_const(findings).of<FakeFindings>().value == 9);
    CHECK(copy.of<FakeFindings>().value == 8);
    CHECK(copy.of<Others>().value == 2);
}

} // namespace abbe::test
