// Renders that are ended in the middle of a tile, a path, a block of light paths or a round of merging: soon, and to go
// on to the bits of one that was not.
#include "base/parallel.h"
#include "render/render_state.h"
#include "support/forwarding_film.h"
#include "support/same_bits.h"
#include "support/scene_test.h"

#include <atomic>
#include <chrono>
#include <doctest/doctest.h>
#include <thread>

namespace abbe::test {
namespace {

// Paths of a thousand vertices, in one tile.
const char* const kWhiteRoom = R"(scene 1
film { size 5 4 }
camera { from 0 1 0.9; look-at 0 1 -1; fov 50 deg }
shape box { size 2 2 2; center 0 1 0; material diffuse { reflectance 0.9999 }; transform { scale 1 1 -1 } }
light sphere { center 0 1.8 0; radius 0.02; radiance 20 }
)";

// A ball of clear glass before a small light, seen in a mirror: light paths and rounds of merging.
const char* const kCaustic = R"(scene 1
film { size 20 12 }
render { light-paths always; merging always }
camera { from 0 2 4; look-at 0 0.3 0; fov 45 deg }
shape quad { points -3 0 -3  -3 0 3  3 0 3  3 0 -3; material diffuse { reflectance 0.7 } }
shape quad { points -2 0 -1  2 0 -1  2 2 -1  -2 2 -1; material conductor { index metal Ag } }
shape sphere { center 0 0.7 0; radius 0.6; material dielectric { ior glass BK7 } }
light sphere { center 1 3 0.5; radius 3 cm; power 800 lm }
light sky { luminance 2 nits }
)";

// Paths of thousands of collisions.
const char* const kFog = R"(scene 1
film { size 4 3 }
camera { from 0 0 3; look-at 0 0 0; fov 40 deg }
light sky { radiance 1 }
shape sphere { radius 1; material boundary; interior homogeneous { extinction 3000 per-m; albedo 0.99999 } }
)";

// Asks for the end after so many events, and is given time to be heard.
class Ending {
  public:
    Ending(std::atomic<bool>& stop, std::uint64_t events) : stop_(stop), last_(events) {}
    void count() {
        if (++counted_ != last_) return;
        stop_ = true;
        std::this_thread::sleep_for(std::chrono::milliseconds(last_ % 3 * 6)); // the watch looks every 5 ms
    }

  private:
    std::atomic<bool>& stop_;
    std::uint64_t last_;
    std::atomic<std::uint64_t> counted_{0};
};

// After additions and splats.
class EndingFilm final : public ForwardingFilm {
  public:
    EndingFilm(RecordingFilm& film, std::atomic<bool>& stop, std::uint64_t additions)
        : ForwardingFilm(film), ending_(stop, additions) {}
    void add(int x, int y, int r, const ExactXyz& sum, std::uint32_t n) noexcept override {
        ForwardingFilm::add(x, y, r, sum, n);
        ending_.count();
    }
    void splat(int x, int y, int r, const Splat& splat) noexcept override {
        ForwardingFilm::splat(x, y, r, splat);
        ending_.count();
    }

  private:
    Ending ending_;
};

// When so many samples have begun: what several threads do is added when all of it is done.
class SampleEndingFilm final : public ForwardingFilm {
  public:
    SampleEndingFilm(RecordingFilm& film, std::atomic<bool>& stop, std::uint64_t samples)
        : ForwardingFilm(film), ending_(stop, samples) {}
    FilterSample filter(Vec2 u) const noexcept override {
        ending_.count();
        return ForwardingFilm::filter(u);
    }

  private:
    mutable Ending ending_;
};

struct Pieces {
    TestImage image;
    int runs = 0, cutTiles = 0, cutBlocks = 0;
};

// Ended after so many events again and again, each time after as many more.
template <typename Film>
Pieces renderInPieces(const TestScene& scene, const RenderSettings& settings, std::uint64_t events) {
    const auto tracer = makePathTracer(scene.scene().effects);
    Pieces p{{RecordingFilm(scene.built().film, 2), {}}};
    p.image.film.keepSplatsOf(*tracer, scene.scene(), settings);
    RenderState state(p.image.film.bounds(), 0, tracer->lightBlocks(scene.scene(), settings));
    while (state.reached() < settings.samplesPerReplicate(2) && ++p.runs < 500) {
        std::atomic<bool> stop = false;
        Film film(p.image.film, stop, 1 + events * static_cast<std::uint64_t>(p.runs));
        p.image.statistics = tracer->render(scene.scene(), film, settings, {&stop, {}, &state});
        for (std::size_t i = 0; i < state.tileCount(); ++i) {
            if (!state.tile(i).cut) continue;
            (state.isLightBlock(i) ? p.cutBlocks : p.cutTiles) += 1;
        }
    }
    CHECK(state.even());
    return p;
}

} // namespace

TEST_CASE("a render cut within pixels and paths goes on to the bits of one that was not") {
    for (const char* text : {kWhiteRoom, kFog}) {
        const auto scene = TestScene::parse(text);
        REQUIRE(scene.report() == "");
        RenderSettings settings = scene.settings();
        settings.samples = 32;
        CAPTURE(text);
        setThreadCount(1);
        const TestImage whole = render(scene, settings, {}, 2);
        const Pieces ofOne = renderInPieces<EndingFilm>(scene, settings, 1);
        setThreadCount(4);
        const Pieces ofMany = renderInPieces<SampleEndingFilm>(scene, settings, 10);
        setThreadCount(0);
        for (const Pieces* pieces : {&ofOne, &ofMany}) {
            CHECK(pieces->cutTiles > 3);
            if (text == kWhiteRoom) // paths that were left, and taken again
                CHECK(pieces->image.statistics.vertices > whole.statistics.vertices);
            CHECK(sameBits(whole.film, pieces->image.film));
            CHECK(whole.statistics.paths == pieces->image.statistics.paths);
        }
    }
}

TEST_CASE("light paths and rounds of merging that are cut go on to the same bits") {
    const auto scene = TestScene::parse(kCaustic);
    REQUIRE(scene.report() == "");
    RenderSettings settings = scene.settings();
    settings.samples = 16;
    settings.pilot = 1;
    const TestImage whole = renderAsProgram(scene, settings, 2);
    REQUIRE(whole.statistics.rounds > 0);
    const Pieces pieces = renderInPieces<EndingFilm>(scene, settings, 200);
    CHECK(pieces.cutBlocks > 0);
    CHECK(sameBits(whole.film, pieces.image.film));
    CHECK(sameLight(whole.film, pieces.image.film));
    CHECK(whole.statistics.lightPaths == pieces.image.statistics.lightPaths);
    CHECK(whole.statistics.rounds == pieces.image.statistics.rounds);
    CHECK(whole.statistics.splats == pieces.image.statistics.splats);
}

// A portion of a single tile would take half a minute.
TEST_CASE("a time limit is kept within the first samples of a tile, and with it what is there") {
    using Clock = std::chrono::steady_clock;
    const auto scene = TestScene::parse(kWhiteRoom);
    RenderSettings settings = scene.settings();
    settings.samples = 4096;
    settings.timeLimit = 0.5;
    RecordingFilm film(scene.built().film, 1024); // replicates: as many samples in the first portion
    const auto tracer = makePathTracer(scene.scene().effects);
    RenderState state(film.bounds(), 0);
    const auto begin = Clock::now();
    tracer->render(scene.scene(), film, settings, {nullptr, {}, &state});
    CHECK(std::chrono::duration<double>(Clock::now() - begin).count() < 1.2);
    CHECK_FALSE(state.empty());
    CHECK(state.reached() == 0);
    REQUIRE(state.tile(0).cut);
    const CutPortion cut = *state.tile(0).cut;
    CHECK(cut.at.unit + cut.at.done > 0);
    CHECK(film.pixelFilm().samples(0, 0) > 0);
}

} // namespace abbe::test
