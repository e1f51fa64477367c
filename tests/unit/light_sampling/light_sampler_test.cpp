// The choice of a light: near ones by the tree, far ones by what they give, and the share of each.
#include "light_sampling/light_sampler.h"
#include "support/chi_square.h"
#include "support/statistics.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

struct Description {
    double power = 1;
    std::uint32_t parts = 0;  // 0: far away
    bool infinite = false;    // met by rays that leave
    double irradiance = 0;    // of far ones
    std::uint32_t dark = 999; // a part without power
    bool even = false;        // the same from everywhere
    float sight = 1;          // of far ones that rays meet
};

template <typename Kind> class TestLight : public Kind {
  public:
    TestLight(const Description& d, std::size_t number) : d_(d), x_(static_cast<float>(number)) {}
    LightOutput output() const override { return {d_.power, d_.power, d_.irradiance, nullptr, d_.even}; }
    std::uint32_t parts() const override { return std::max(d_.parts, 1u); }
    std::optional<LightBounds> bounds(std::uint32_t part) const override {
        if (d_.parts == 0) return std::nullopt;
        const Vec3 p{x_, 2, static_cast<float>(part)};
        const double power = part == d_.dark ? 0 : d_.power / d_.parts;
        return LightBounds{.box = {p, p}, .power = static_cast<float>(power)};
    }
    std::optional<LightSample> sample(const Receiver&, std::uint32_t, Vec2, const Wavelengths&,
                                      float) const noexcept override {
        return std::nullopt;
    }

  protected:
    Description d_;

  private:
    float x_;
};

class DistantTestLight final : public TestLight<DistantLight> {
  public:
    using TestLight::TestLight;
    Spectrum escaped(Vec3, const Wavelengths&, float) const noexcept override { return Spectrum(0.f); }
    float pdfEscaped(const Receiver&, Vec3, float) const noexcept override { return 0; }
    float inSight(const Receiver&) const noexcept override { return d_.sight; }
};

std::unique_ptr<const Light> lightOf(const Description& d, std::size_t number) {
    if (d.infinite) return std::make_unique<DistantTestLight>(d, number);
    return std::make_unique<TestLight<Light>>(d, number);
}

using Lights = std::vector<std::unique_ptr<const Light>>;

Lights lightsOf(std::initializer_list<Description> list) {
    Lights lights;
    for (const Description& d : list) lights.push_back(lightOf(d, lights.size()));
    return lights;
}

const Receiver kFloor({0.5f, 0, 0.5f}, {0, 1, 0}, false);

// Of every other group of lights nothing arrives at the floor, nearly, and half of the rest.
LightArrival behindWalls() {
    std::vector<SpaceTree::Place> places{{kFloor.p, faceOf(kFloor.n), 0}};
    const SpaceTree cells(places, 1);
    LightArrival::Factors factors;
    for (std::size_t g = 0; g < factors.size(); ++g) factors[g] = g % 2 ? 0.5f : 0.02f;
    return {cells, std::vector<LightArrival::Factors>(cells.leaves(), factors)};
}

void checkPicks(const LightSampler& sampler, const Lights& lights, const LightArrival* arrival) {
    std::vector<std::pair<const Light*, std::uint32_t>> all;
    std::vector<double> expected;
    constexpr int picks = 100000;
    double sum = 0;
    for (const auto& light : lights)
        for (std::uint32_t part = 0; part < light->parts(); ++part) {
            all.emplace_back(light.get(), part);
            const auto p = static_cast<double>(sampler.probability(light.get(), part, kFloor, {}, arrival));
            sum += p;
            expected.push_back(p * picks);
        }
    CHECK(sum == doctest::Approx(1).epsilon(1e-5));
    std::vector<double> observed(all.size(), 0);
    Random random(7);
    int different = 0;
    for (int i = 0; i < picks; ++i) {
        const PickedLight p = sampler.pick(random.uniform(), kFloor, {}, arrival);
        different += p.probability != sampler.probability(p.light, p.part, kFloor, {}, arrival);
        ++observed[static_cast<std::size_t>(std::find(all.begin(), all.end(), std::pair(p.light, p.part)) -
                                            all.begin())];
    }
    CHECK(different == 0);
    if (all.size() > 1) CHECK(chiSquareTest(observed, expected).pValue > 1e-4);
    for (const float u : {0.f, 0.5f, kOneMinusEpsilon}) CHECK(sampler.pick(u, kFloor, {}, arrival).probability > 0);
    CHECK(sampler.needsChoice() == (all.size() > 1));
}

} // namespace

TEST_CASE("light choice: probabilities sum to one over all parts, and are those of the picks") {
    const Lights cases[] = {
        lightsOf({{.power = 3, .parts = 1}}),
        lightsOf({{.power = 3, .parts = 1}, {.power = 1, .parts = 5, .dark = 2}}),
        lightsOf({{.infinite = true, .irradiance = 1}, {.irradiance = 2}, {}}),
        lightsOf({{.infinite = true, .irradiance = 10, .sight = 0},
                  {.irradiance = 2},
                  {.infinite = true, .irradiance = 3, .sight = 0.1f}}),
        lightsOf({{.infinite = true, .irradiance = 10, .sight = 0}, {.infinite = true, .irradiance = 2, .sight = 0}}),
        lightsOf(
            {{.power = 3, .parts = 7}, {.infinite = true, .irradiance = 0.01}, {.irradiance = 0.3}, {.parts = 1}})};
    const LightArrival walls = behindWalls();
    for (const Lights& lights : cases)
        for (const auto choice : {Technique::LightChoice::tree, Technique::LightChoice::power}) {
            const LightSampler sampler(lights, choice);
            for (const LightArrival* const arrival : {static_cast<const LightArrival*>(nullptr), &walls})
                checkPicks(sampler, lights, arrival);
        }
}

TEST_CASE("light choice: what is behind walls is picked as much less as less of it arrives") {
    const Lights lights =
        lightsOf({{.power = 1, .parts = 1}, {.power = 1, .parts = 1}, {.infinite = true, .irradiance = 0.1}});
    const LightSampler sampler(lights);
    const LightArrival walls = behindWalls();
    const auto of = [&](std::size_t i, const LightArrival* arrival) {
        return static_cast<double>(sampler.probability(lights[i].get(), 0, kFloor, {}, arrival));
    };
    REQUIRE(sampler.hasGroups());
    CHECK(sampler.groupOf(lights[2].get(), 0) == LightArrival::kBranches);
    std::size_t hidden = sampler.groupOf(lights[0].get(), 0) == 0u ? 0 : 1;
    CHECK(of(hidden, &walls) / of(1 - hidden, &walls) ==
          doctest::Approx(0.04 * of(hidden, nullptr) / of(1 - hidden, nullptr)).epsilon(1e-3));
    CHECK(of(2, &walls) < 0.2 * of(2, nullptr));
    // In media nothing is known.
    CHECK(sampler.probability(lights[2].get(), 0, Receiver(kFloor.p), {}, &walls) ==
          sampler.probability(lights[2].get(), 0, Receiver(kFloor.p)));
}

TEST_CASE("light choice: near and far lights each keep a share of the picks") {
    const auto far = [](const Lights& lights, const Receiver& at) {
        return LightSampler(lights).probability(lights[1].get(), 0, at);
    };
    const Receiver there({0, 1e4f, 0}, {0, -1, 0}, false);
    // A blazing sky, and next to none.
    const Lights day = lightsOf({{.power = 1, .parts = 3}, {.infinite = true, .irradiance = 1e9}});
    const Lights night = lightsOf({{.power = 1, .parts = 3}, {.infinite = true, .irradiance = 1e-9}});
    CHECK(far(day, kFloor) == doctest::Approx(1 - LightSampler::kLeastShare));
    CHECK(far(night, kFloor) == doctest::Approx(LightSampler::kLeastShare));
    // Where both give as much: 1 W at 2 m against the same irradiance.
    const double near = 1 / (4.0 * 2 * kPiD);
    const Lights even = lightsOf({{.power = 1, .parts = 1}, {.infinite = true, .irradiance = near}});
    CHECK(far(even, Receiver({0, 0, 0}, {0, 1, 0}, false)) == doctest::Approx(0.5).epsilon(1e-3));
    CHECK(far(even, there) > 0.8f);
    // The same through windows that show a quarter of the sky.
    const Lights room =
        lightsOf({{.power = 1, .parts = 1}, {.infinite = true, .irradiance = 4 * near, .sight = 0.25f}});
    CHECK(far(room, Receiver({0, 0, 0}, {0, 1, 0}, false)) == doctest::Approx(0.5).epsilon(1e-3));
}

// docs/hard_cases.md, case 35.
TEST_CASE("light choice: dark lights are never picked, and no lights at all are no light") {
    const Lights dark = lightsOf({{.power = 0, .parts = 1}, {.power = 0, .infinite = true}});
    CHECK(LightSampler(dark).empty());
    CHECK(LightSampler({}).empty());
    const Lights one = lightsOf({{.power = 0, .parts = 1}, {.power = 2, .parts = 1}, {.power = 0}});
    const LightSampler sampler(one);
    CHECK_FALSE(sampler.needsChoice());
    CHECK(sampler.pick(0.7f, kFloor).light == one[1].get());
    CHECK(sampler.probability(one[0].get(), 0, kFloor) == 0);
    CHECK(sampler.probability(one[1].get(), 0, kFloor) == 1);
    CHECK(sampler.probability(one[1].get(), 1, kFloor) == 0);
    // Of another scene.
    CHECK(sampler.probability(dark[0].get(), 0, kFloor) == 0);
}

TEST_CASE("light choice: even skies are left to scattering, where it finds them and there is anything else") {
    const auto sampler = [](const Lights& lights, bool leavesEven = true,
                            Technique::LightChoice choice = Technique::LightChoice::tree) {
        return LightSampler(lights, choice, kNeverStop, leavesEven);
    };
    const Description sky{.infinite = true, .irradiance = 3, .even = true}, sun{.infinite = true, .irradiance = 6};
    const Lights both = lightsOf({sky, sun}), lamp = lightsOf({sky, {.power = 2, .parts = 3}});
    CHECK(sampler(both).probability(both[0].get(), 0, kFloor) == 0);
    CHECK(sampler(both).probability(both[1].get(), 0, kFloor) == 1);
    CHECK(sampler(both).infinite().size() == 2); // rays still meet both
    CHECK(sampler(lamp).probability(lamp[0].get(), 0, kFloor) == 0);
    for (const float u : {0.f, 0.5f, kOneMinusEpsilon}) {
        CHECK(sampler(both).pick(u, kFloor).light == both[1].get());
        CHECK(sampler(lamp).pick(u, kFloor).light == lamp[1].get());
    }
    CHECK(sampler(both, false).probability(both[0].get(), 0, kFloor) > 0.3f);
    CHECK(sampler(both, true, Technique::LightChoice::uniform).probability(both[0].get(), 0, kFloor) == 0.5f);
    // Nothing else is there, or all else is dark.
    const Lights skies = lightsOf({sky, sky, {.power = 0, .infinite = true}});
    CHECK(sampler(skies).probability(skies[0].get(), 0, kFloor) == 0.5f);
    // Scattered rays do not see it.
    Lights hidden = lightsOf({sun});
    auto seen = std::make_unique<DistantTestLight>(sky, 1);
    seen->setVisible(RayKind::camera);
    hidden.push_back(std::move(seen));
    CHECK(sampler(hidden).probability(hidden[1].get(), 0, kFloor) > 0.3f);
}

TEST_CASE("light choice along a ray: lights that are there") {
    const Lights lights = lightsOf({{.parts = 4}, {.infinite = true, .irradiance = 100}});
    const LightSampler sampler(lights);
    CHECK(sampler.placed());
    const Ray ray{{0, 2, -3}, {0, 0, 1}};
    const RayExtent extent{1, 6};
    double sum = 0;
    for (std::uint32_t part = 0; part < 4; ++part)
        sum += static_cast<double>(sampler.probabilityAlong(lights[0].get(), part, ray, extent));
    CHECK(sum == doctest::Approx(1).epsilon(1e-5));
    CHECK(sampler.probabilityAlong(lights[1].get(), 0, ray, extent) == 0);
    const PickedLight p = sampler.pickAlong(0.3f, ray, extent);
    CHECK(p.probability == sampler.probabilityAlong(p.light, p.part, ray, extent));
    CHECK_FALSE(LightSampler(lightsOf({{.irradiance = 1}})).placed());
}

} // namespace abbe::test
