// Idle threads take part in a block of light paths, in a round of merging and in a dear tile: a single one of these
// keeps all of them at work.
#include "base/parallel.h"
#include "base/work.h"
#include "render/render_state.h"
#include "support/forwarding_film.h"
#include "support/same_bits.h"
#include "support/scene_test.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <doctest/doctest.h>
#include <mutex>
#include <set>
#include <thread>

namespace abbe::test {
namespace {

const char* const kBallBeforeMirror = R"(scene 1
film { size 32 32 }
render { light-paths always; merging always }
camera { from 0 2 4; look-at 0 0.3 0; fov 45 deg }
shape quad { points -3 0 -3  -3 0 3  3 0 3  3 0 -3; material diffuse { reflectance 0.7 } }
shape quad { points -2 0 -1  2 0 -1  2 2 -1  -2 2 -1; material conductor { index metal Ag } }
shape sphere { center 0 0.7 0; radius 0.6; material dielectric { ior glass BK7 } }
light sphere { center 1 3 0.5; radius 3 cm; power 800 lm }
light sky { luminance 2 nits }
)";

// Holds every thread that comes until so many different ones are there; for a minute, but once.
class Rendezvous {
  public:
    explicit Rendezvous(std::size_t wanted) : wanted_(wanted) {}
    void arrive() {
        std::unique_lock lock(mutex_);
        if (met_.size() >= wanted_ || gaveUp_) return;
        met_.insert(std::this_thread::get_id());
        changed_.notify_all();
        if (!changed_.wait_for(lock, std::chrono::seconds(60), [this] { return met_.size() >= wanted_ || gaveUp_; }))
            gaveUp_ = true;
        changed_.notify_all();
    }
    std::size_t met() const { return met_.size(); }

  private:
    std::size_t wanted_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::set<std::thread::id> met_;
    bool gaveUp_ = false;
};

// Light paths ask it for the weight of their splats' places, and rounds for places in their pixels.
class MeetingFilm final : public ForwardingFilm {
  public:
    MeetingFilm(RecordingFilm& film, std::size_t threads) : ForwardingFilm(film), paths(threads), rounds(threads) {}
    float filterWeight(float offset) const noexcept override {
        if (isAtLight()) paths.arrive();
        return ForwardingFilm::filterWeight(offset);
    }
    FilterSample filter(Vec2 u) const noexcept override {
        if (isAtLight()) rounds.arrive();
        return ForwardingFilm::filter(u);
    }

    mutable Rendezvous paths, rounds;

  private:
    static bool isAtLight() { return (workState.flags.load() & static_cast<std::uint8_t>(WorkFlag::light)) != 0; }
};

// One tile.
const char* const kBallOnFloor = R"(scene 1
film { size 16 16 }
camera { from 0 2 4; look-at 0 0.3 0; fov 45 deg }
shape plane { material diffuse { reflectance 0.7 } }
shape sphere { center 0 0.7 0; radius 0.6; material diffuse { reflectance 0.4 } }
light sky { luminance 200 nits }
)";

// Samples of pixels ask it for their places; from when it is told on.
class PixelMeetingFilm final : public ForwardingFilm {
  public:
    PixelMeetingFilm(RecordingFilm& film, std::size_t threads) : ForwardingFilm(film), samples(threads) {}
    FilterSample filter(Vec2 u) const noexcept override {
        if (begun && (workState.flags.load() & static_cast<std::uint8_t>(WorkFlag::pilot)) == 0) samples.arrive();
        return ForwardingFilm::filter(u);
    }

    mutable Rendezvous samples;
    std::atomic<bool> begun = false;
};

RenderSettings fewSamples(const TestScene& scene) {
    RenderSettings settings = scene.settings();
    settings.samples = 8;
    settings.pilot = 1;
    return settings;
}

} // namespace

TEST_CASE("one block of light paths, and one round of merging, is the work of all threads") {
    constexpr std::size_t kThreads = 4; // be there as many cores or not
    const auto scene = TestScene::parse(kBallBeforeMirror);
    REQUIRE(scene.report() == "");
    const RenderSettings settings = fewSamples(scene);
    setThreadCount(1);
    const TestImage alone = renderAsProgram(scene, settings, 2);
    REQUIRE(alone.statistics.rounds > 0);

    setThreadCount(static_cast<int>(kThreads));
    const auto tracer = makePathTracer(scene.scene().effects);
    TestImage image{RecordingFilm(scene.built().film, 2), {}};
    image.film.keepSplatsOf(*tracer, scene.scene(), settings);
    MeetingFilm film(image.film, kThreads);
    RenderState state(image.film.bounds(), 0, 1);
    image.statistics = tracer->render(scene.scene(), film, settings, {nullptr, {}, &state});
    setThreadCount(0);
    CHECK(film.paths.met() == kThreads);
    CHECK(film.rounds.met() == kThreads);

    CHECK(sameBits(alone.film, image.film));
    CHECK(sameLight(alone.film, image.film));
    CHECK(alone.statistics.lightPaths == image.statistics.lightPaths);
    CHECK(alone.statistics.lightRays == image.statistics.lightRays);
    CHECK(alone.statistics.splats == image.statistics.splats);
    CHECK(alone.statistics.rounds == image.statistics.rounds);
}

TEST_CASE("a tile that is most of the work is that of all threads, but for its first samples") {
    constexpr std::size_t kThreads = 4;
    const auto scene = TestScene::parse(kBallOnFloor);
    REQUIRE(scene.report() == "");
    RenderSettings settings = scene.settings();
    settings.samples = 64;
    setThreadCount(1);
    const TestImage alone = render(scene, settings, {}, 2);

    setThreadCount(static_cast<int>(kThreads));
    TestImage image{RecordingFilm(scene.built().film, 2), {}};
    PixelMeetingFilm film(image.film, kThreads);
    RenderControl control;
    control.passEnded = [&] { film.begun = true; };
    image.statistics = makePathTracer(scene.scene().effects)->render(scene.scene(), film, settings, control);
    setThreadCount(0);
    CHECK(film.samples.met() == kThreads);
    CHECK(sameBits(alone.film, image.film));
    CHECK(sameCounts(alone.statistics, image.statistics));
}

} // namespace abbe::test
