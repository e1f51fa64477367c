// Which light manifold sampling has: what it can start at, what it follows, and what it leaves to the path tracer.
#include "support/manifold_cases.h"
#include "transport/surroundings.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

const std::string kHead = "scene 1\ncamera { from 0 0 -20; look-at 0 0 0 }\n";

// Candidates of a scene by their names, and why they are none.
std::map<std::string, std::string> candidates(const std::string& text) {
    const TestScene scene = TestScene::parse(kHead + "light sky { radiance 1 }\n" + text);
    REQUIRE(scene.report() == "");
    std::map<std::string, std::string> list;
    for (const CasterCandidate& c : casterCandidates(scene.scene())) list[scene.scene().names.at(c.shape)] = c.obstacle;
    return list;
}

// A wavy sheet of quads.
std::string sheet(int n, const char* more) {
    std::string points, faces;
    for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j) points += fmt::format("- {} {} {}; ", i, 0.1 * ((i + j) % 2), j);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const int a = i * (n + 1) + j;
            faces += fmt::format("- {} {} {} {}; ", a, a + 1, a + n + 2, a + n + 1);
        }
    return fmt::format("shape sheet mesh {{ points {{ {} }}; faces {{ {} }}; {} }}\n", points, faces, more);
}

constexpr Lobes kMirrored = Lobes(Lobe::delta) | Lobe::reflection;
constexpr Lobes kThrough = Lobes(Lobe::delta) | Lobe::transmission;

} // namespace

TEST_CASE("casters: every polished shape is named, with what keeps chains from being followed over it") {
    const auto list = candidates(
        "material glass dielectric { ior 1.5 }\n"
        "shape paper quad { size 9 9; material diffuse }\n"
        "shape tiles quad { size 9 9; material diffuse { reflectance checker { scale 1 } } }\n"
        "shape frosted sphere { center 3 0 0; material dielectric { roughness 0.3 } }\n"
        "shape ball sphere { material glass }\n"
        "shape egg sphere { center 0 4 0; transform { scale 1 1.2 1 }; material glass }\n"
        "shape ring torus { major-radius 1; minor-radius 0.1; transform { translate 0 9 0 }; material conductor { "
        "index metal Au } }\n"
        "shape water plane { center 0 -9 0; material dielectric { ior 1.33 } }\n"
        "shape pane quad { size 1 1; material thin-dielectric; transform { translate 0 0 5 } }\n"
        "shape varnished sphere { center 0 -4 0; material openpbr { base-color 0.2; specular-roughness 0 } }\n"
        "shape tinted sphere { center 5 0 0; material conductor { index metal Ag; tint noise { scale 1 } } }\n"
        "shape dented sphere { center 7 0 0; material conductor { index metal Ag; bump 2 mm { map noise { scale 1 cm } "
        "} } }\n"
        "shape veil quad { size 1 1; material conductor { index metal Ag; opacity 0.5 }; transform { translate 0 0 7 } "
        "}\n"
        "shape hair curves { points 0 0 0  0 1 0  0 2 0  0 3 0; radius 0.1; material glass }\n"
        "object pebbles { shape pebble sphere { radius 0.1; material glass } }\n"
        "instance pebbles { transform { translate 0 0 9 } }\n");
    const auto has = [&](const char* name, const char* part) {
        CAPTURE(name);
        REQUIRE(list.contains(name));
        if (*part == 0)
            CHECK(list.at(name) == "");
        else
            CHECK_MESSAGE(list.at(name).find(part) != std::string::npos, list.at(name));
    };
    CHECK_FALSE(list.contains("paper"));
    CHECK_FALSE(list.contains("tiles")); // looks at textures, but is matte whatever they say
    CHECK_FALSE(list.contains("frosted"));
    for (const char* name : {"ball", "egg", "ring", "water", "pane", "varnished"}) has(name, "");
    has("tinted", "textures");
    has("dented", "textures");
    has("veil", "open");
    has("hair", "not known");
    has("pebble", "instances");
}

TEST_CASE("casters: flat faces are followed as long as they are few") {
    CHECK(candidates(sheet(8, "material conductor { index metal Ag }")).at("sheet") == "");
    CHECK(candidates(sheet(20, "material conductor { index metal Ag }")).at("sheet").find("400 faces") !=
          std::string::npos);
}

TEST_CASE("a chain is covered as long as every vertex belongs to it") {
    ManifoldCase test("shape ball sphere { center 0 1.6 0; radius 1; material dielectric { ior 1.5 } }\n"
                      "shape frosted sphere { center 4 0 0; material dielectric { roughness 0.3 } }\n"
                      "light sphere { center 1.5 7 0; radius 0.1; radiance 1 }\nlight sky { radiance 1 }\n");
    REQUIRE(test.scene.report() == "");
    const Scene& scene = test.scene.scene();
    ManifoldPlan plan = test.sampler->plan();
    plan.lights.resize(1);
    plan.casters[0].weights[ManifoldKinds::indexOf(ChainSignature::of("RR"))] = 0;
    const ManifoldSampler sampler(scene, plan);
    const Shape& ball = *plan.casters[0].shape;
    const Light& emitter = *plan.lights[0].light;
    // A path that goes by way of the ball to the light, as Newton's method finds it.
    const ChainStart start = test.start({-0.3f, 0, 0.2f});
    const Wavelengths lambda = Wavelengths::sample(0.3f);
    RandomStream random(3);
    std::optional<ManifoldSample> sample;
    LightTarget target;
    const ManifoldChoice choice{0, ChainSignature::of("TT"), 1};
    ManifoldCounts counts;
    while (!sample) {
        target = *LightTarget::sample(emitter, 0, 1, {random.uniform(), random.uniform()}, lambda, 0);
        sample = sampler.estimate(start, target, choice, lambda, random, counts);
    }
    const auto covered = [&](std::initializer_list<std::pair<const Shape*, Lobes>> vertices) {
        CoveredChain chain;
        chain.start();
        for (const auto& [shape, lobe] : vertices) sampler.follow(chain, shape, lobe);
        return sampler.covers(chain, start, sample->wi, target, lambda);
    };
    CHECK(covered({{&ball, kThrough}, {&ball, kThrough}}));
    CHECK_FALSE(covered({}));
    CHECK_FALSE(covered({{&ball, kThrough}, {&ball, Lobes(Lobe::glossy) | Lobe::transmission}}));
    CHECK_FALSE(covered({{&ball, kMirrored}, {&ball, kMirrored}})); // weight 0
    const Shape& frosted = *scene.surfaces.at(1).shape;
    CHECK_FALSE(covered({{&frosted, kThrough}, {&ball, kThrough}}));
    CHECK_FALSE(covered({{&ball, kThrough}, {&ball, kThrough}, {&ball, kThrough}, {&ball, kThrough}}));
    LightTarget other = target;
    other.light = scene.lights.at(1).get();
    CoveredChain chain;
    chain.start();
    sampler.follow(chain, &ball, kThrough);
    sampler.follow(chain, &ball, kThrough);
    CHECK_FALSE(sampler.covers(chain, start, sample->wi, other, lambda));
    chain.stop();
    CHECK_FALSE(sampler.covers(chain, start, sample->wi, target, lambda));
    // The light's image there is a few 1e-3 sr.
    for (auto& light : plan.lights) light.largestImage = 1e-5f;
    const ManifoldSampler stricter(scene, plan);
    chain = {};
    chain.start();
    stricter.follow(chain, &ball, kThrough);
    stricter.follow(chain, &ball, kThrough);
    CHECK_FALSE(stricter.covers(chain, start, sample->wi, target, lambda));
    CHECK_FALSE(stricter.estimate(start, target, choice, lambda, random, counts).has_value());
}

TEST_CASE("what surrounds the receiver counts: glass in water is glass of their relative index") {
    const auto light = [](const std::string& shapes, bool inside, const char* signature, std::uint32_t caster) {
        const ManifoldCase test(shapes + "light sphere { center 1.5 6 0; radius 0.1; radiance 1 }\n");
        REQUIRE(test.scene.report() == "");
        ChainStart start = test.start(*signature == 'T' ? Vec3{-0.3f, 0, 0.2f} : Vec3{3, 0, 0.5f});
        if (inside) start.around = surroundingsAt(test.scene.scene(), start.receiver.p, 0);
        std::vector<float> all;
        ManifoldCounts counts;
        RandomStream random(11);
        const Wavelengths lambda = Wavelengths::sample(0.3f);
        for (int i = 0; i < 800; ++i) {
            const Vec2 u{random.uniform(), random.uniform()};
            const auto target = LightTarget::sample(*test.scene.scene().lights.at(0), 0, 1, u, lambda, 0);
            const auto s = test.sampler->estimate(start, *target, {caster, ChainSignature::of(signature), 1}, lambda,
                                                  random, counts);
            all.push_back(s ? s->irradiance[0] : 0);
        }
        return all;
    };
    const std::string ball =
        "shape sphere {{ center 0 1.6 0; radius 1; material dielectric {{ ior {}; absorption {} }} }}\n";
    for (const char* signature : {"TT", "R"}) {
        const auto air = light(fmt::format(fmt::runtime(ball), 1.6 / 1.25, 0.4), false, signature, 0);
        const auto water = light("shape box { size 30 30 30; material dielectric { ior 1.25 } }\n" +
                                     fmt::format(fmt::runtime(ball), 1.6, 0.4),
                                 true, signature, 1);
        REQUIRE(air.size() == water.size());
        int lit = 0;
        for (std::size_t i = 0; i < air.size(); ++i) {
            CHECK(water[i] == doctest::Approx(air[i]).epsilon(1e-4));
            lit += air[i] > 0;
        }
        CHECK(lit > 20);
    }
    // A ball of the water itself is not there: it neither is a vertex nor dims the light.
    const auto plain = light(fmt::format(fmt::runtime(ball), 1.5, 0), false, "TT", 0);
    const auto veiled =
        light(fmt::format(fmt::runtime(ball), 1.5, 0) + "shape sphere { center -0.1 0.3 0.1; radius 0.1; material "
                                                        "boundary; interior homogeneous { extinction 0.1 per-m } }\n",
              false, "TT", 0);
    CHECK(plain == veiled);
}

} // namespace abbe::test
