// What is said of paths that go on and on: where, how many, and what it takes.

#include "reports/render_warnings.h"
#include "support/scene_test.h"

#include <doctest/doctest.h>

using namespace abbe;

TEST_CASE("pixels without a sample: the time is blamed only where it ended early") {
    const auto said = [](bool allBegun, std::uint64_t dropped) {
        Diagnostics diagnostics;
        warnOfMissingSamples({25, {0, 0, 10, 10}, allBegun, dropped}, diagnostics);
        REQUIRE(diagnostics.all().size() == 1);
        CHECK(diagnostics.all()[0].code == "W0668");
        CHECK(diagnostics.all()[0].message.find("25 % of the image") != std::string::npos);
        return diagnostics.all()[0].message + diagnostics.all()[0].help;
    };
    CHECK(said(false, 0).find("the time ended before") == 0);
    CHECK(said(false, 0).find("dropped") == std::string::npos);
    CHECK(said(false, 3).find("the time ended before every pixel had a sample, and samples were dropped") == 0);
    CHECK(said(true, 3).find("all samples of some pixels were dropped") == 0);
    CHECK(said(true, 3).find("time") == std::string::npos);
    Diagnostics diagnostics;
    warnOfMissingSamples({0, {0, 0, 10, 10}, true, 3}, diagnostics);
    CHECK(diagnostics.all().empty());
}

TEST_CASE("densities above their bounds: a few are no news, many are a warning") {
    for (const std::uint64_t above : {0, 9, 10, 500}) {
        Diagnostics diagnostics;
        warnOfDensities({1000, above, 2.5f}, diagnostics);
        REQUIRE(diagnostics.all().size() == (above >= 10 ? 1 : 0));
        if (above < 10) continue;
        CHECK(diagnostics.all()[0].code == "W0643");
        CHECK(diagnostics.all()[0].message.find("2.5 times") != std::string::npos);
    }
    Diagnostics diagnostics;
    warnOfDensities({}, diagnostics);
    CHECK(diagnostics.all().empty());
}

namespace abbe::test {
namespace {

const char* const kTwoMirrors = R"(scene 1
camera { from 0 0 3; look-at 0 0 0 }
light sky { radiance 1 }
medium milk homogeneous { extinction 100 per-m; albedo 1 }
shape left sphere { radius 1; material diffuse { reflectance 0.5 } }
shape sphere { center 2 0 0; radius 1; material boundary; interior milk }
)";

struct TwoMirrors {
    TestScene scene = TestScene::parse(kTwoMirrors);
    const void* left = nullptr;
    const void* milk = scene.scene().media.at(0).get();
    TwoMirrors() {
        for (const auto& [thing, name] : scene.scene().names)
            if (name == "left") left = thing;
    }
};

} // namespace

TEST_CASE("paths that lose nothing are told with their shapes, where they are declared, and the time that it takes") {
    const TwoMirrors t;
    REQUIRE(t.left);
    FramePreview look;
    Diagnostics diagnostics;
    warnOfEndlessPaths(look, t.scene.built(), 64, diagnostics);
    CHECK(diagnostics.all().empty());
    look.endless.shapes = {static_cast<const Shape*>(t.left)};
    look.endless.share = 0.37;
    look.raysOfPath = 412;
    look.secondsForSample = 2;
    warnOfEndlessPaths(look, t.scene.built(), 64, diagnostics);
    REQUIRE(diagnostics.all().size() == 1);
    const Diagnostic& d = diagnostics.all()[0];
    CHECK(d.code == "W0647");
    CHECK(d.span.valid());
    CHECK(d.message == "paths go round without losing light: 412 rays each in the mean, of `left`");
    REQUIRE(d.notes.size() == 2);
    CHECK(d.notes[0].find("37 %") != std::string::npos);
    CHECK(d.notes[1] == "as it is, the render takes about 02:08");
}

TEST_CASE("paths that were cut are told with their share, and the shapes and media where they were") {
    const TwoMirrors t;
    RenderStatistics statistics;
    Diagnostics diagnostics;
    statistics.paths = 1000;
    warnOfCappedPaths(statistics, t.scene.built(), diagnostics);
    CHECK(diagnostics.all().empty());
    statistics.cappedPaths = 30;
    statistics.cappedIn = {{t.left, 10}, {t.milk, 20}};
    warnOfCappedPaths(statistics, t.scene.built(), diagnostics);
    REQUIRE(diagnostics.all().size() == 1);
    const Diagnostic& d = diagnostics.all()[0];
    CHECK(d.code == "W0642");
    CHECK(d.span.valid());
    CHECK(d.message == "30 paths (3 %) were cut at the safety cap on vertices, in `milk`, `left`; the light that they "
                       "would have found is missing");
    CHECK(d.related.size() == 1);
}

} // namespace abbe::test
