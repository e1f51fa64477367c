// Renders in pieces: stopped and continued, snapshots on the way, parts of the samples. The bits are those of the
// whole.
#include "render/render_state.h"
#include "rendering/time_left.h"
#include "support/forwarding_film.h"
#include "support/same_bits.h"
#include "support/scene_test.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

const char* const kScene = R"(scene 1
film { size 37 21 }
camera { from 0.4 0.9 4; look-at 0 0.4 0; fov 40 deg }
shape plane { material diffuse { reflectance rgb 0.7 0.4 0.2 } }
shape sphere { center 0 0.5 0; radius 0.5; material dielectric { ior 1.5; roughness 0.3 } }
light quad { points -1 2 -1  -1 2 1  1 2 1  1 2 -1; luminance 3000 nits }
light sky { luminance 100 nits }
)";

// Sets a flag after so many additions to another film.
class StoppingFilm final : public ForwardingFilm {
  public:
    StoppingFilm(RecordingFilm& film, std::atomic<bool>& stop, std::uint64_t additions)
        : ForwardingFilm(film), stop_(stop), last_(additions) {}
    void add(int x, int y, int r, const ExactXyz& sum, std::uint32_t n) noexcept override {
        ForwardingFilm::add(x, y, r, sum, n);
        if (++added_ >= last_) stop_ = true;
    }

  private:
    std::atomic<bool>& stop_;
    std::uint64_t last_;
    std::atomic<std::uint64_t> added_{0};
};

} // namespace

TEST_CASE("a render stopped at any moment and continued has the bits and counts of one that was not") {
    const auto scene = TestScene::parse(kScene);
    REQUIRE(scene.report() == "");
    RenderSettings settings = scene.settings();
    settings.samples = 40; // of two replicates
    const TestImage whole = render(scene, settings, {}, 2);

    RecordingFilm film(scene.built().film, 2);
    RenderState state(film.bounds(), 0);
    const auto tracer = makePathTracer(scene.scene().effects);
    RenderStatistics statistics;
    bool uneven = false;
    for (std::uint64_t run = 0; run < 1000 && state.reached() < 20; ++run) {
        std::atomic<bool> stop = false;
        StoppingFilm stopping(film, stop, run * 700); // from the middle of a tile to some tiles
        const RenderControl control{&stop, {}, &state};
        statistics = tracer->render(scene.scene(), stopping, settings, control);
        uneven = uneven || !state.even();
        state.seconds = statistics.seconds;
        CHECK(statistics.stopped == (state.reached() < 20));
    }
    CHECK(uneven);
    CHECK(state.reached() == 20);
    CHECK(statistics.samplesPerPixel == 40);
    CHECK(sameBits(whole.film, film));
    CHECK(sameCounts(whole.statistics, statistics));

    // Continued beyond what was the end; and asked again for less.
    RenderSettings more = settings;
    more.samples = 64;
    const RenderControl control{nullptr, {}, &state};
    statistics = tracer->render(scene.scene(), film, more, control);
    const TestImage longer = render(scene, more, {}, 2);
    CHECK(sameBits(longer.film, film));
    CHECK(sameCounts(longer.statistics, statistics));
    statistics = tracer->render(scene.scene(), film, settings, control);
    CHECK(statistics.samplesPerPixel == 64);
    CHECK(sameBits(longer.film, film));
}

TEST_CASE("snapshots are taken between portions and change nothing") {
    const auto scene = TestScene::parse(kScene);
    RenderSettings settings = scene.settings();
    settings.samples = 64;
    const TestImage whole = render(scene, settings, {}, 2);
    RecordingFilm film(scene.built().film, 2);
    RenderState state(film.bounds(), 0);
    std::atomic<bool> snapshot = true;
    int taken = 0;
    RenderControl control{nullptr, {}, &state, &snapshot, {}};
    control.takeSnapshot = [&](const RenderStatistics& s) {
        CHECK_FALSE(snapshot);
        CHECK(s.stopped);
        // The film holds what the tiles say and nothing else.
        for (std::size_t i = 0; i < state.tileCount(); ++i) {
            const PixelBounds b = state.pixels(i);
            for (int r = 0; r < 2; ++r) CHECK(film.replicate(b.x0, b.y0, r).second == state.tile(i).reached);
        }
        if (++taken < 5) snapshot = true;
    };
    const RenderStatistics statistics =
        makePathTracer(scene.scene().effects)->render(scene.scene(), film, settings, control);
    CHECK(taken == 5);
    CHECK_FALSE(statistics.stopped);
    CHECK(sameBits(whole.film, film));
    CHECK(sameCounts(whole.statistics, statistics));
}

TEST_CASE("parts of the samples add up to the whole, wherever their boundaries are") {
    const auto scene = TestScene::parse(kScene);
    RenderSettings settings = scene.settings();
    settings.samples = 46; // 23 of each replicate: thirds are not whole passes
    const TestImage whole = render(scene, settings, {}, 2);
    RecordingFilm film(scene.built().film, 2); // all parts into one
    RenderStatistics sum;
    for (const std::uint32_t part : {3u, 1u, 2u}) {
        RenderSettings one = settings;
        one.part = part;
        one.parts = 3;
        const RenderStatistics s = makePathTracer(scene.scene().effects)->render(scene.scene(), film, one, {});
        sum.paths += s.paths;
        sum.vertices += s.vertices;
        sum.shadowRays += s.shadowRays;
    }
    CHECK(sameBits(whole.film, film));
    CHECK(sameCounts(whole.statistics, sum));
    settings.parts = 99; // more than samples: some parts are empty
    std::uint32_t count = 0;
    for (settings.part = 1; settings.part <= 99; ++settings.part) {
        const SampleRange range = settings.range(2);
        CHECK(range.first == count);
        count = range.last;
    }
    CHECK(count == 23);
}

TEST_CASE("the pass of any sample ends where that of the whole render does") {
    for (std::uint32_t first = 0, end = passEnd(0); end <= 256; first = end, end = passEnd(end))
        for (std::uint32_t sample = first; sample < end; ++sample) CHECK(endOfPassWith(sample) == end);
    CHECK(endOfPassWith(0xfffffff0u) == 0xffffffffu);
}

} // namespace abbe::test
