// Which light is left to probes, and where they go.
// Which glints the pilot finds.
#include "caustics/glints/glint_plan.h"
#include "caustics/glints/glint_search.h"
#include "render/light.h"
#include "support/caustics_of.h"
#include "support/scene_test.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

const auto* const kLight = reinterpret_cast<const Light*>(0x10); // never looked at

GlintPlan plan(std::vector<Glint> glints) { return {{0, 0, 40, 30}, 1.5f, std::move(glints), {kLight}}; }

} // namespace

TEST_CASE("glints: chains are told apart by their events and their length") {
    CHECK(ChainSignature::of("TRT") == ChainSignature::of("TRT"));
    CHECK(ChainSignature::of("TRT") != ChainSignature::of("TTR"));
    CHECK(ChainSignature::of("R") != ChainSignature::of("RR"));
    CHECK(ChainSignature::of("TRT")[0] == ChainEvent::transmission);
    CHECK(ChainSignature::of("TRT")[1] == ChainEvent::reflection);
    ChainSignature longest;
    for (int i = 0; i < ChainSignature::kMaxLength; ++i) longest.add(ChainEvent::transmission);
    ChainSignature longer = longest;
    longer.add(ChainEvent::transmission);
    CHECK(longer != longest);
    CHECK(longer.length() > ChainSignature::kMaxLength);
}

TEST_CASE("glints: a place belongs to the chain whose box has it") {
    const GlintPlan p =
        plan({{ChainSignature::of("R"), {{4, 4}, {6, 6}}, 4}, {ChainSignature::of("TRT"), {{5, 5}, {9, 9}}, 4}});
    const auto row = p.ofRow(5);
    CHECK(p.covers(row, ChainSignature::of("R"), {4.5f, 5.5f}));
    CHECK(!p.covers(row, ChainSignature::of("R"), {7, 7}));
    CHECK(p.covers(row, ChainSignature::of("TRT"), {7, 7}));
    CHECK(!p.covers(row, ChainSignature::of("TT"), {5.5f, 5.5f}));
    CHECK(p.has(kLight));
    CHECK(!p.has(kLight + 1));
}

TEST_CASE("glints: boxes of one chain that overlap become one, so that nothing is probed twice") {
    const ChainSignature r = ChainSignature::of("R");
    // The third joins the first two, which then reach the fourth.
    const GlintPlan p = plan({{r, {{0, 0}, {2, 2}}, 2},
                              {r, {{10, 0}, {12, 2}}, 3},
                              {r, {{1, 0}, {11, 3}}, 4},
                              {r, {{5, 2.5f}, {6, 8}}, 2},
                              {ChainSignature::of("T"), {{0, 0}, {2, 2}}, 2}});
    REQUIRE(p.glints().size() == 2);
    const auto& whole = p.glints()[0].chain == r ? p.glints()[0] : p.glints()[1];
    CHECK(whole.box.lower.x == 0);
    CHECK(whole.box.upper.x == 12);
    CHECK(whole.box.upper.y == 8);
    CHECK(whole.side == 4);
}

TEST_CASE("glints: pixels within reach of the filter know of a box") {
    const GlintPlan p = plan({{ChainSignature::of("R"), {{4, 10}, {6, 11}}, 4}});
    for (int y = 0; y < 30; ++y) {
        const float nearest = std::max({0.f, 10 - (static_cast<float>(y) + 0.5f), static_cast<float>(y) + 0.5f - 11});
        CHECK(p.ofRow(y).empty() == (nearest >= 1.5f));
    }
    CHECK(p.ofRow(-1).empty());
    CHECK(p.ofRow(30).empty());
}

TEST_CASE("glints: a forced lobe has all of the light that chance would find") {
    const auto scene = test::TestScene::parse("scene 1\ncamera { from 0 0 5; look-at 0 0 0 }\n"
                                              "shape sphere { material dielectric { ior 1.5 } }\nlight sky {}\n");
    SurfaceHit hit;
    hit.ng = {0, 0, 1};
    hit.material = scene.scene().materials.front().get();
    Arena arena;
    const Bsdf& bsdf = *hit.material->bsdf(hit, Wavelengths::sample(0.3f), arena);
    const Vec3 wo = normalize(Vec3{0.5f, 0.2f, 0.8f});
    for (const bool transmission : {false, true}) {
        const auto forced = forcedLobe(bsdf, wo, transmission);
        REQUIRE(forced);
        const auto sampled = bsdf.sample(wo, transmission ? 0.9f : 0.001f, {0.5f, 0.5f}, Transport::radiance);
        REQUIRE(sampled);
        CHECK(isForced(bsdf, wo, *sampled));
        CHECK(forced->sample.weight[0] == doctest::Approx(sampled->weight[0] * sampled->pdfSolidAngle));
        CHECK(forced->probability == doctest::Approx(sampled->pdfSolidAngle));
    }
    // Beyond the critical angle there is one lobe, with certainty.
    const Vec3 inside = normalize(Vec3{0.9f, 0, -0.3f});
    CHECK(!forcedLobe(bsdf, inside, true));
    REQUIRE(forcedLobe(bsdf, inside, false));
    CHECK(forcedLobe(bsdf, inside, false)->probability == doctest::Approx(1));
}

} // namespace abbe

namespace abbe::test {

// A ball before a mirror. The light is seen in the ball; in the mirror in the ball; and in the ball in the mirror in
// the ball, which is 0.02 pixels wide, while the slope from which Newton's method goes there changes its sign within
// 0.2.
TEST_CASE("glints: the light in a ball in a mirror in that ball") {
    const TestScene scene =
        TestScene::parse("scene 1 length=cm\nfilm { size 240 180 }\nrender { max-depth 3 }\n"
                         "camera { from 4 23 44; look-at 1 5 -5; lens 48 mm }\n"
                         "shape plane { material diffuse { reflectance 0.75 } }\n"
                         "shape sphere { center -4 3.5 -2; radius 3.5; material conductor { index metal Ag } }\n"
                         "shape quad { size 36 22; material conductor { index metal Ag }\n"
                         "    transform { translate 0 11 0; rotate x -6 deg; rotate y -8 deg; translate 0 0 -15 } }\n"
                         "light sphere { center -48 42 -12; radius 0.4; power 900 lm }\n");
    REQUIRE(scene.report() == "");
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
        RenderSettings settings = scene.settings();
        settings.seed = seed;
        CAPTURE(seed);
        CHECK(causticsOf(scene, settings).of<GlintFindings>().found == 3);
    }
}

} // namespace abbe::test
