// What is said of paths that go on and on: where, how many, and what it takes.
#include "reports/render_warnings.h"
#include "support/scene_test.h"

#include <doctest/doctest.h>

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
    FirstLook look;
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
