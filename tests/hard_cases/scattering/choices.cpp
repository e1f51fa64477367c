// Which light, which lobe, which weight: cases 35 to 39 of docs/hard_cases.md.
#include "doctor/numeric_check.h"
#include "hard_cases/hard_case.h"
#include "light_sampling/light_tree.h"
#include "math/distribution.h"
#include "support/chi_square.h"
#include "support/scene_test.h"

using namespace abbe;
using namespace abbe::test;

TEST_CASE("case 35: black environments, black textures of lights, lights without power") {
    HardCase c;
    int bad = 0, warnings = 0;
    for (const char* lights :
         {"light sky { radiance 0 }\nlight quad { points -1 2 -1  1 2 -1  1 2 1  -1 2 1; radiance 1 }",
          "light point { position 0 2 0; power 0 W }\nlight sphere { center 3 2 2; radius 0.5; radiance 1 }",
          "light quad { points -1 2 -1  1 2 -1  1 2 1  -1 2 1; radiance 1; texture ramp { stop 0 0; stop 1 0 } }\n"
          "light sphere { center 3 2 2; radius 0.5; radiance 1 }"}) {
        const TestScene scene = TestScene::parse(
            std::string("scene 1\nfilm { size 8 8 }\ncamera { from 0 1 4; look-at 0 0 0 }\nshape plane\n") + lights +
            "\n");
        if (scene.diagnostics().hasErrors()) {
            MESSAGE(scene.report());
            ++bad;
            continue;
        }
        warnings += !scene.diagnostics().all().empty();
        const TestImage image = render(scene, 16);
        bad += image.statistics.dropped != std::array<std::uint64_t, 3>{};
        double sum = 0;
        for (int i = 0; i < 64; ++i) sum += image.film.mean(i % 8, i / 8).y;
        bad += !(sum > 0 && std::isfinite(sum));
        if (!(sum > 0)) MESSAGE(std::string(lights), sum);
    }
    const Distribution1D none(std::vector<double>(8, 0.0));
    for (int i = 0; i < 8; ++i) bad += none.probability(static_cast<std::size_t>(i)) != 0.125;
    bad += none.total() != 0 || warnings == 0;
    c.measured("faults with black lights beside others", bad, 0);
    const volatile float weight = 0, total = 0;
    c.naive("probability of one black bin among others", static_cast<double>(weight / total));
}

// A random number of a render has 24 bits: all 2²⁴ of them are tried, where 1e9 random ones would repeat each 60 times.
TEST_CASE("case 36: a random number next to 1") {
    HardCase c;
    c.measured("empty bins drawn, by all 2²⁴ random numbers from five tables", doctor::emptyBinsDrawn(), 0);
    // The first bin whose cumulative weight in single precision exceeds u.
    const std::vector<float> weights(100, 0.1f);
    float total = 0, sum = 0;
    for (const float w : weights) total += w;
    int past = 1;
    for (const float w : weights) past = past && (sum += w * (1 / total)) <= kOneMinusEpsilon;
    float reached = 0; // the same weights in another order of operations
    for (const float w : weights) reached += w / total;
    c.naive("bins past the end by cumulative sums in single precision",
            past + (reached <= kOneMinusEpsilon) + (sum <= kOneMinusEpsilon));
}

TEST_CASE("case 37: reuse of a random number") {
    HardCase c;
    // 1024 equal lights in a row: ten choices of one of two, one after the other from one number, then the place on the
    // light from what is left of it.
    std::vector<double> table(2, 0.5);
    const Distribution1D half(table);
    std::vector<double> left, plain;
    Random random(3);
    for (int i = 0; i < 20000; ++i) {
        double u = random.uniformDouble();
        float v = static_cast<float>(u);
        for (int k = 0; k < 22; ++k) v = v < 0.5f ? 2 * v : 2 * v - 1;
        plain.push_back(static_cast<double>(v));
        BinSample s = half.sample(static_cast<float>(u));
        for (int k = 1; k < 10; ++k) s = half.sample(s.offset);
        left.push_back(static_cast<double>(s.offset) + 0x1p-15 * random.uniformDouble()); // it has 14 bits left
    }
    std::vector<double> counts(64, 0.0), expected(64, 20000.0 / 64), plainCounts(64, 0.0);
    for (std::size_t i = 0; i < left.size(); ++i) {
        ++counts[std::min<std::size_t>(63, static_cast<std::size_t>(left[i] * 64))];
        ++plainCounts[std::min<std::size_t>(63, static_cast<std::size_t>(plain[i] * 64))];
    }
    c.atLeast("p of χ² of what is left of a number after ten choices", chiSquareTest(counts, expected).pValue, 1e-4);
    c.naive("after 22 choices of a number of 24 bits", chiSquareTest(plainCounts, expected).pValue);
    // The tree of lights goes on in double.
    std::vector<LightBounds> lights;
    for (int i = 0; i < 1024; ++i) {
        const Vec3 p(static_cast<float>(i % 32), 0, static_cast<float>(i / 32));
        LightBounds b;
        b.box = {p, p};
        b.power = 1;
        lights.push_back(b);
    }
    const LightTree tree(lights);
    std::vector<double> picks(1024, 0.0), wanted;
    const Receiver from(Vec3(16, 1e4f, 16));
    for (int i = 0; i < 200000; ++i) ++picks[tree.pick(random.uniformDouble(), from).light];
    for (std::uint32_t i = 0; i < 1024; ++i)
        wanted.push_back(200000.0 * static_cast<double>(tree.probability(i, from)));
    c.atLeast("p of χ² of 1024 lights picked by ten choices each", chiSquareTest(picks, wanted).pValue, 1e-4);
}

// A light so small that its density per solid angle is 3e19: its square has no place in single precision.
TEST_CASE("case 38: MIS weights of extreme densities") {
    HardCase c;
    const auto shown = [](const char* emitter) {
        const TestScene scene = TestScene::parse(
            std::string(
                "scene 1\nfilm { size 4 4; filter box 0.5 }\ncamera { from 0 2 0.1; look-at 0 0 0; fov 10 deg }\n"
                "shape plane { material conductor { index metal Ag; roughness 1 } }\n") +
            emitter);
        REQUIRE_MESSAGE(!scene.diagnostics().hasErrors(), scene.report());
        const TestImage image = render(scene, 64);
        CHECK(image.statistics.dropped == std::array<std::uint64_t, 3>{});
        return image.film.image().mean;
    };
    const double point = shown("light point { position 1 1 0; power 100 W }\n");
    double worst = 0;
    for (const char* radius : {"1e-3", "1e-6", "1e-10", "1e-15"}) {
        const double emitter =
            shown(fmt::format("light sphere {{ center 1 1 0; radius {}; power 100 W }}\n", radius).c_str());
        const double off = std::abs(emitter / point - 1);
        worst = off <= worst ? worst : off;
    }
    c.measured("light of area lights of 1e-3 to 1e-15 m over that of a point", worst, 1e-3);
    const volatile float light = 3e19f, bsdf = 3e19f;
    c.naive("power heuristic of two densities of 3e19",
            static_cast<double>(light * light / (light * light + bsdf * bsdf)));
}

TEST_CASE("case 39: mirrors beside matte lobes") {
    HardCase c;
    const TestScene scene = TestScene::parse(
        "scene 1\nfilm { size 12 12; filter box 0.5 }\ncamera { from 0 0.5 4; look-at 0 0 0; fov 40 deg }\n"
        "light sky { radiance 0.3 }\nlight sphere { center 2 3 2; radius 1; radiance 3 }\n"
        "shape plane { center 0 -0.8 0 }\n"
        "shape sphere { center -0.6 0 0; radius 0.7; material mix { first dielectric { ior 1.5 }\n"
        "    second diffuse { reflectance rgb 0.7 0.2 0.1 }; amount 40 % } }\n");
    const auto images = renderByEachStrategy(scene, 1024);
    double worst = 0;
    for (std::size_t i = 1; i < 3; ++i) {
        const Estimate a = images[0].film.image(), b = images[i].film.image();
        worst = std::max(worst, std::abs(a.mean - b.mean) / std::sqrt(a.variance + b.variance));
    }
    c.measured("difference between both strategies and each alone, glass with paint on it, in standard errors", worst,
               3);
}
