// What effects cost and show: found where they are, cancelled where they change nothing, predicted by the cost report.
#include "study/effect_study.h"
#include "support/scene_test.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

EffectStudy studyOf(const std::string& text, int pairs, std::uint32_t samples) {
    SourceMap sources;
    Diagnostics diagnostics;
    const schema::TypeTable types = makeTypeTable();
    const FileId file = sources.add("test.scene", text);
    const auto document = abbe::parse(sources, file, {}, diagnostics);
    const schema::SceneTree tree = schema::resolve(document, types, ABBE_SOURCE_DIR, diagnostics);
    INFO(formatShort(diagnostics, sources));
    REQUIRE(!diagnostics.hasErrors());
    Diagnostics faults;
    buildScene(tree, types, {}, faults);
    INFO(formatShort(faults, sources));
    REQUIRE(!faults.hasErrors());
    EffectStudyInput input;
    input.tree = &tree;
    input.types = &types;
    input.pairs = pairs;
    input.samples = samples;
    return measureEffects(input);
}

constexpr const char* kRoom = R"(scene 1
camera { from 0 1 3.4; look-at 0 1 0; fov 45 deg }
film   { size 24 16 }
light lamp quad { points { - -0.3 1.99 -0.3; - 0.3 1.99 -0.3; - 0.3 1.99 0.3; - -0.3 1.99 0.3 }; luminance 5000 nits }
shape floor quad { points { - -1 0 1; - 1 0 1; - 1 0 -1; - -1 0 -1 }; material diffuse { reflectance 0.5 } }
shape back quad { points { - -1 0 -1; - 1 0 -1; - 1 2 -1; - -1 2 -1 }; material diffuse { reflectance 0.5 } }
)";

} // namespace

TEST_CASE("study of effects: a scene without any has nothing to find") {
    const EffectStudy study = studyOf(kRoom, 2, 4);
    CHECK(study.findings.empty());
    CHECK(study.cost.paths == 24 * 16 * 4);
    CHECK(study.image.rgb.size() == 3 * 24 * 16);
}

TEST_CASE("study of effects: a cloud takes time and is seen; glass that hides behind the camera is neither") {
    const EffectStudy study =
        studyOf(std::string(kRoom) + // what pilots spend in the cloud no cost report predicts
                    "render { light-paths off }\nmedium fog homogeneous { extinction 2 per-m; albedo 0.9 }\n"
                    "shape cloud sphere { center 0 1 0.5; radius 0.6; material boundary; interior fog }\n"
                    "shape far sphere { center 0 1 40; radius 0.01; material dielectric { ior glass SF11 } }\n",
                4, 64);
    REQUIRE(study.findings.size() == 2);
    for (const EffectFinding& f : study.findings) {
        CHECK(f.reason.empty());
        CHECK(f.low <= f.deltaTime);
        CHECK(f.deltaTime <= f.high);
        CHECK(f.image.rgb.size() == 3 * 24 * 16);
        const double share = (f.secondsOn - f.secondsOff) / f.secondsOn;
        CHECK(f.deltaTime == doctest::Approx(share).epsilon(0.1));
        if (f.name == "volume fog") {
            CHECK(f.deltaTime > 0.1);
            CHECK(f.flip > 0.02);
            CHECK(f.relMse > 0.01);
            REQUIRE(f.predicted); // how well: docs/performance.md; two measurements of a tenth of a second say little
            CHECK(*f.predicted > 0.1);
            CHECK(*f.predicted < 1);
        } else {
            CHECK(f.name == "dispersion");
            CHECK(f.relMse == 0); // the same seeds make the same paths
            CHECK(f.flip == 0);
        }
    }
}

TEST_CASE("study of effects: what cannot be built without it says why") {
    // The flame is the only light.
    const EffectStudy study = studyOf(R"(scene 1
camera { from 0 1 3.4; look-at 0 1 0; fov 45 deg }
film   { size 8 8 }
shape floor quad { points { - -1 0 1; - 1 0 1; - 1 0 -1; - -1 0 -1 }; material diffuse { reflectance 0.5 } }
volume flame vdb "scenes/candle/candle.vdb" { density; temperature; flame; extinction 30 per-m; albedo 0.1
    emissivity 30 per-m; transform { translate 0 0.099 0 } }
)",
                                      2, 2);
    REQUIRE(study.findings.size() == 1);
    CHECK(study.findings[0].reason.find("no light") != std::string::npos);
}

TEST_CASE("prediction: of a volume, by rays that nothing scattered") {
    CostReport cost;
    cost.rendering = 10;
    cost.paths = 1000;
    cost.untouched = 2000;
    cost.rows = {{"camera", "", 1, 0, 0, 0, 0},
                 {"film", "", 1, 0, 0, 0, 0},
                 {"motion", "", 0.5, 0, 0, 0, 0},
                 {"volume fog", "", 2, 0, 3, 0, 0}};
    cost.rows[3].first = 500;
    // 8 s that are not the camera's or the film's, 5 of them because of the fog; 1000 · 1500/500 rays for 2000.
    CHECK(*renderingWithout(cost, {SwitchedEffect::medium, "fog"}) == doctest::Approx(2 + 3 * 1.5));
    CHECK(*renderingWithout(cost, {SwitchedEffect::motion}) == doctest::Approx(9.5));
    CHECK(*renderingWithout(cost, {SwitchedEffect::dispersion}) == 10);
    CHECK(!renderingWithout(cost, {SwitchedEffect::displacement}));
    CHECK(!renderingWithout(cost, {SwitchedEffect::medium, "smoke"}));
    cost.rows[3].first = 800; // most of them: what the others did says little
    CHECK(!renderingWithout(cost, {SwitchedEffect::medium, "fog"}));
}

} // namespace abbe::test
