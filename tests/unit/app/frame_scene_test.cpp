// A scene set to a frame of an animation: its moment, its parameter, its seed, and what makes it that frame.
#include "app/load.h"
#include "checkpoints/render_identity.h"
#include "film/film_params.h"
#include "render_run/frame_run.h"
#include "rendering/render_params.h"
#include "scene/build.h"

#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <set>
#include <unistd.h>

namespace abbe::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kScene = R"(scene 1
param frame 0 deg
film { size 8 8 }
render { fps 10; seed 3 }
camera { time 0.25 s; from 0 1 4; look-at 0 0.5 0; shutter 0.05 s }
light sky { luminance 5000 nits }
shape box { material diffuse; transform { rotate y $frame } }
)";

struct FrameScene {
    fs::path path = fs::temp_directory_path() / ("abbe_frame_" + std::to_string(getpid()) + ".scene");
    std::unique_ptr<LoadedScene> loaded;
    BuiltScene built;

    FrameScene(const std::string& text, std::optional<int> frame, std::optional<std::int64_t> seed = {}) {
        std::ofstream(path) << text;
        loaded = loadScene({path.string(), {}, false, frame});
        BuildOptions options;
        options.geometry = false;
        options.seed = seed;
        built = buildScene(loaded->tree, loaded->types, options, loaded->diagnostics);
        CHECK_MESSAGE(loaded->diagnostics.errorCount() == 0,
                      (loaded->diagnostics.all().empty() ? "" : loaded->diagnostics.all()[0].message));
    }
    ~FrameScene() { fs::remove(path); }

    std::vector<Fact> identity() const {
        const FilmSettings film = filmSettings(built.film);
        const RenderSettings settings = renderSettings(built.render);
        return renderIdentity({loaded.get(), &film, &settings, 2, {}, built.render.fps});
    }
    std::string fingerprint(RenderOptions options = {}) const {
        return frameFingerprint(options, {loaded.get(), &built, filmSettings(built.film).crop});
    }
};

std::string without(std::string text, const std::string& part, const std::string& instead = "") {
    const auto at = text.find(part);
    REQUIRE(at != std::string::npos);
    return text.replace(at, part.size(), instead);
}

} // namespace

TEST_CASE("a frame has its moment, its parameter and its seed") {
    const FrameScene frame(kScene, 7), still(kScene, std::nullopt), first(kScene, 0);
    CHECK(frame.built.shutter.open == doctest::Approx(0.95));
    CHECK(frame.built.shutter.duration == doctest::Approx(0.05));
    CHECK(frame.built.render.seed == 10);
    CHECK(frame.loaded->tree.document->parameters[0].values()[0].number == 7);
    CHECK(frame.loaded->tree.document->parameters[0].values()[1].text == "deg");
    CHECK(still.built.shutter.open == 0.25);
    CHECK(first.built.shutter.open == 0.25);
    CHECK(still.built.render.seed == 3);
    CHECK(first.built.render.seed == 3);
    CHECK(FrameScene(kScene, 7, 20).built.render.seed == 20);
    CHECK(FrameScene(kScene, -7).built.shutter.open == doctest::Approx(-0.45));
}

TEST_CASE("seeds of frames stay within what a seed may be") {
    CHECK(seedOfFrame(0, 7) == 7);
    CHECK(seedOfFrame(0, -1) == 9007199254740991);
    CHECK(seedOfFrame(9007199254740991, 2) == 1);
    std::set<std::int64_t> seeds;
    for (int frame = -50; frame <= 50; ++frame) seeds.insert(seedOfFrame(5, frame));
    CHECK(seeds.size() == 101);
}

TEST_CASE("a scene without the parameter has frames all the same, and a scene knows whether they differ") {
    const std::string still = without(without(kScene, "param frame 0 deg\n"), "$frame", "5 deg");
    CHECK(FrameScene(kScene, 7).loaded->changesWithFrames());
    CHECK_FALSE(FrameScene(still, 7).loaded->changesWithFrames());
    CHECK_FALSE(FrameScene(without(kScene, "$frame", "5 deg"), 7).loaded->changesWithFrames());
    const std::string moving = without(still, "rotate y 5 deg", "at 0 s { rotate y 5 deg }; at 1 s { rotate y 7 deg }");
    CHECK(FrameScene(moving, 7).loaded->changesWithFrames());
    CHECK(FrameScene(still, 7).built.shutter.open == doctest::Approx(0.95));
}

TEST_CASE("the frame is part of what makes two renders one") {
    const FrameScene seven(kScene, 7), eight(kScene, 8), still(kScene, std::nullopt);
    CHECK(frameOf(seven.identity()) == 7);
    CHECK(frameOf(FrameScene(kScene, -7).identity()) == -7);
    CHECK_FALSE(frameOf(still.identity()));
    const auto lines = differences(eight.identity(), seven.identity(), "the part", "the scene");
    bool named = false;
    for (const std::string& line : lines) named = named || line == "frame: `8` in the part, `7` in the scene";
    CHECK(named);
    // A rate that shows the same moment in another frame is told, too.
    CHECK_FALSE(
        differences(FrameScene(without(kScene, "fps 10", "fps 20"), 7).identity(), seven.identity(), "a", "b").empty());
}

TEST_CASE("a fingerprint tells frames of different renders apart") {
    const FrameScene seven(kScene, 7);
    const std::string own = seven.fingerprint();
    CHECK(own == FrameScene(kScene, 7).fingerprint());
    CHECK(own == FrameScene("// a comment\n" + std::string(kScene), 7).fingerprint());
    CHECK(own != FrameScene(kScene, 8).fingerprint());
    CHECK(own != FrameScene(without(kScene, "seed 3", "seed 4"), 7).fingerprint());
    CHECK(own != FrameScene(without(kScene, "size 8 8", "size 8 8; output \"x.exr\" space=acescg"), 7).fingerprint());
    RenderOptions brighter;
    brighter.view.exposure = 1;
    CHECK(own != seven.fingerprint(brighter));
}

TEST_CASE("images and parts of frames have names of their own") {
    CHECK(frameImagePath("shot.####.exr", 7, {}) == "shot.0007.exr");
    CHECK(frameImagePath("shot.####.exr", 7, Vec2i{2, 4}) == "shot.0007.part2.abbe");
    for (const char* pattern : {"shot.exr", "shot", "shot.####", "shot_#", "a/shot.##.abbe"}) {
        std::set<std::string> names;
        for (int frame = -3; frame < 12; ++frame)
            for (int part = 1; part <= 2; ++part) names.insert(frameImagePath(pattern, frame, Vec2i{part, 2}));
        CHECK_MESSAGE(names.size() == 30, pattern);
    }
}

} // namespace abbe::test
