// A list of techniques for caustics: whose turn it is in a block, what they tell, and what their rays come to.
// How large pilots become, and that they stay small beside what they plan.
#include "base/parallel.h"
#include "caustics/shared/pilot.h"
#include "light_sampling/light_sampler.h"
#include "render/render_state.h"
#include "rendering/caustic_plans.h"
#include "rendering/path_tracer.h"
#include "support/caustics_of.h"
#include "support/scene_test.h"

#include <chrono>
#include <cmath>
#include <doctest/doctest.h>
#include <thread>

namespace abbe::test {
namespace {

struct FakeFindings {
    int value = 7;
};

// Does units of a block up to the one that it is told to stop at, counts them as rounds and notes where it began.
class FakeTechnique final : public CausticTechnique {
  public:
    bool blocks = true;
    std::optional<std::uint32_t> stopsAt;
    mutable std::vector<PortionPlace> begun;

    void plan(const PilotInput&) override {}
    bool used() const override { return blocks; }
    void giveTo(PathContext&) const override {}
    std::optional<TileResult> render(const PathContext&, const LightPathKernel&, Film& film,
                                     const BlockJob& job) const override {
        if (!blocks) return std::nullopt;
        TileResult result;
        const std::uint32_t units = job.units(film);
        if (job.from.unit >= units) return result;
        begun.push_back(job.from);
        const std::uint32_t end = stopsAt.value_or(units);
        result.rounds = end - job.from.unit;
        if (stopsAt) result.rest = PortionPlace{end, 5};
        return result;
    }
    void report(CausticFindings& to) const override { to.of<FakeFindings>().value = 3; }
    Rays rays() const override { return {10, 0.25}; }
};

// The first and the last of three have work in blocks, of three samples of two replicates.
struct FakePlans {
    FakeTechnique *first, *second, *third;
    CausticPlans plans;

    FakePlans() {
        std::vector<std::unique_ptr<CausticTechnique>> list;
        for (FakeTechnique** const place : {&first, &second, &third}) {
            auto technique = std::make_unique<FakeTechnique>();
            *place = technique.get();
            list.push_back(std::move(technique));
        }
        second->blocks = false;
        plans = CausticPlans(std::move(list));
    }
    TileResult render(PortionPlace from) const {
        const TestScene test =
            TestScene::parse("scene 1\ncamera { from 0 0 5; look-at 0 0 0 }\nlight sky { luminance 1 nits }\n");
        const LightSampler lights(test.scene().lights);
        PilotPixel film({0, 0, 1, 1}, 2);
        return plans.render({test.scene(), lights, {}}, {}, film, {4, 7, 0, 1, from});
    }
};

} // namespace

TEST_CASE("caustic plans: units of a technique follow those of the one before it") {
    const FakePlans fake;
    const TileResult whole = fake.render({});
    CHECK(whole.rounds == 12);
    CHECK_FALSE(whole.rest);
    REQUIRE(fake.first->begun.size() == 1);
    REQUIRE(fake.third->begun.size() == 1);
    CHECK(fake.third->begun[0].unit == 0);
}

TEST_CASE("caustic plans: a block goes on where it was cut short, with the technique that was at work") {
    const FakePlans fake;
    fake.first->stopsAt = 2;
    const TileResult cut = fake.render({});
    CHECK(cut.rounds == 2);
    REQUIRE(cut.rest);
    CHECK(cut.rest->unit == 2);
    CHECK(fake.third->begun.empty()); // waits for its turn
    fake.first->stopsAt.reset();
    fake.third->stopsAt = 1;
    const TileResult later = fake.render(*cut.rest);
    CHECK(later.rounds == 4 + 1);
    REQUIRE(later.rest);
    CHECK(later.rest->unit == 6 + 1);
    CHECK(fake.first->begun.back().done == 5);
    CHECK(fake.third->begun.back().unit == 0);
    CHECK(fake.third->begun.back().done == 0);
    fake.third->stopsAt.reset();
    const TileResult last = fake.render(*later.rest);
    CHECK(last.rounds == 5);
    CHECK_FALSE(last.rest);
    CHECK(fake.first->begun.size() == 2); // has done all of its own
    CHECK(fake.third->begun.back().unit == 1);
    CHECK(fake.third->begun.back().done == 5);
}

TEST_CASE("caustic plans: rays and findings are those of all techniques") {
    const FakePlans fake;
    CHECK(fake.plans.any());
    CHECK(fake.plans.pilotRays() == 30);
    CHECK(fake.plans.raysOfSample(2) == kCostBesideLightPaths * 2 + 0.75);
    CHECK(fake.plans.findings().of<FakeFindings>().value == 3);
    CHECK(CausticPlans().raysOfSample(2) == 2);
    CHECK_FALSE(CausticPlans().any());
}

TEST_CASE("caustic findings: a record of each type, as it is by default where nobody told it") {
    struct Others {
        int value = 1;
    };
    CausticFindings findings;
    CHECK(std::as_const(findings).of<FakeFindings>().value == 7);
    auto& record = findings.of<FakeFindings>();
    record.value = 8;
    findings.of<Others>().value = 2; // which leaves the first where it is
    const CausticFindings copy = findings;
    record.value = 9;
    CHECK(std::as_const(findings).of<FakeFindings>().value == 9);
    CHECK(copy.of<FakeFindings>().value == 8);
    CHECK(copy.of<Others>().value == 2);
}

} // namespace abbe::test

namespace abbe::test {
namespace {

const std::function<bool()> kGoesOn = [] { return false; };

// Took so many rays to find nothing.
class RaysAlone final : public CausticTechnique {
  public:
    explicit RaysAlone(std::uint64_t rays) : rays_(rays) {}
    void plan(const PilotInput&) override {}
    bool used() const override { return false; }
    void giveTo(PathContext&) const override {}
    void report(CausticFindings&) const override {}
    Rays rays() const override { return {rays_, 0}; }

  private:
    std::uint64_t rays_;
};

// In the place of pilots: so many rays, four times as many for each larger size.
struct RaysOfPilots {
    std::vector<int> sent;
    double secondsOfSmallest = 0;

    PilotRun run(std::uint64_t raysOfSmallest) {
        return [this, raysOfSmallest](int size, const std::function<bool()>& stop) {
            sent.push_back(size);
            const double factor = std::pow(4, size - 1);
            const auto end =
                std::chrono::steady_clock::now() + std::chrono::duration<double>(secondsOfSmallest * factor);
            while (std::chrono::steady_clock::now() < end && !stop()) std::this_thread::yield();
            std::vector<std::unique_ptr<CausticTechnique>> techniques;
            techniques.push_back(
                std::make_unique<RaysAlone>(static_cast<std::uint64_t>(static_cast<double>(raysOfSmallest) * factor)));
            return CausticPlans(std::move(techniques));
        };
    }
};

// A ball of glass over a floor.
std::string ballPictureText(int side, int samples) {
    return "scene 1\nfilm { size " + std::to_string(side) + " " + std::to_string(side) + " }\nrender { samples " +
           std::to_string(samples) + R"( }
camera { from 0 2 4; look-at 0 0.3 0; fov 45 deg }
shape quad { points -3 0 -3  -3 0 3  3 0 3  3 0 -3; material diffuse { reflectance 0.7 } }
shape ball sphere { center 0 0.7 0; radius 0.6; material dielectric { ior glass BK7 } }
light lamp sphere { center 1 3 0.5; radius 3 cm; power 800 lm }
light fill sky { luminance 2 nits }
)";
}

TestImage renderByPilot(const TestScene& scene, int pilot) {
    RenderSettings settings = scene.settings();
    settings.pilot = pilot;
    return renderAsProgram(scene, settings, 2);
}

bool samePilotPictures(const TestImage& a, const TestImage& b) {
    const PixelBounds bounds = a.film.bounds();
    for (int y = bounds.y0; y < bounds.y1; ++y)
        for (int x = bounds.x0; x < bounds.x1; ++x) {
            const Xyz p = a.film.mean(x, y), q = b.film.mean(x, y);
            if (p.x != q.x || p.y != q.y || p.z != q.z) return false;
        }
    return true;
}

} // namespace

TEST_CASE("pilots: the largest that a budget of rays has room for") {
    struct Case {
        double budget;
        int size;
    };
    for (const Case c : {Case{0, 1}, {4999, 1}, {5000, 2}, {16999, 2}, {17000, 3}, {64999, 3}, {65000, 4}, {1e9, 4}}) {
        RaysOfPilots pilots;
        const LadderedPlans found = climb(pilots.run(1000), {c.budget, 0, true}, kGoesOn);
        CAPTURE(c.budget);
        CHECK(found.size == c.size);
        CHECK(found.plans.pilotRays() == static_cast<std::uint64_t>(1000 * std::pow(4, c.size - 1)));
        CHECK(static_cast<double>(found.rays) <= std::max(c.budget, 1000.0));
        CHECK(pilots.sent.front() == 1);
        CHECK(pilots.sent.size() <= 2);
    }
}

TEST_CASE("pilots: what they would take too long for is not begun, and what takes too long does not count") {
    RaysOfPilots pilots;
    pilots.secondsOfSmallest = 0.02;
    const LadderedPlans small = climb(pilots.run(1000), {1e9, 0.07, false}, kGoesOn); // size 2 would take 0.08 s
    CHECK(small.size == 1);
    CHECK(pilots.sent == std::vector{1});
    RaysOfPilots slow;
    slow.secondsOfSmallest = 60;
    const LadderedPlans none = climb(slow.run(1000), {1e9, 0.02, false}, kGoesOn);
    CHECK(none.size == 0);
    CHECK(none.seconds < 30);
    CHECK(none.plans.pilotRays() == 0);
    RaysOfPilots asked;
    asked.secondsOfSmallest = 0.03;
    CHECK(climb(asked.run(1000), {1e9, 0.01, true}, kGoesOn).size == 1); // the smallest, whatever they take
}

TEST_CASE("pilots: of a size, or none") {
    RaysOfPilots pilots;
    CHECK(plansOf(pilots.run(10), 3, kGoesOn).plans.pilotRays() == 160);
    CHECK(plansOf(pilots.run(10), 0, kGoesOn).size == 0);
    CHECK(pilots.sent == std::vector{3});
    CHECK(plansOf(pilots.run(10), 2, [] { return true; }).size == 0);
}

// The smallest are sent whatever the picture is; else a fortieth, and the look at the frame, which is a path a pixel.
TEST_CASE("pilots: a fortieth of the rays of a render at most, larger for larger ones" * doctest::test_suite("sweep")) {
    const TestScene tiny = TestScene::parse(ballPictureText(24, 16));
    const std::uint64_t smallest = renderByPilot(tiny, 1).statistics.pilotRays;
    int before = 0;
    for (const int samples : {16, 1024, 8192}) {
        const TestScene scene = TestScene::parse(ballPictureText(24, samples));
        const TestImage image = renderByPilot(scene, RenderSettings::kPilotByWork);
        const RenderStatistics& s = image.statistics;
        CAPTURE(samples);
        CAPTURE(s.caustics.pilot);
        CHECK(static_cast<double>(s.pilotRays) <=
              0.025 * static_cast<double>(s.rays()) + static_cast<double>(smallest));
        CHECK(s.caustics.pilot >= before);
        before = s.caustics.pilot;
        CHECK(s.pilotRays > 0);
    }
    CHECK(before > 1);
    CHECK(renderByPilot(tiny, RenderSettings::kPilotByWork).statistics.caustics.pilot == 1);
    CHECK(renderByPilot(tiny, 4).statistics.pilotRays > 8 * smallest);
}

TEST_CASE("pilots: a render by its work has the bits of one with pilots of that size, for any threads") {
    const TestScene scene = TestScene::parse(ballPictureText(20, 128));
    const TestImage byWork = renderByPilot(scene, RenderSettings::kPilotByWork);
    const int size = byWork.statistics.caustics.pilot;
    CHECK(byWork.statistics.caustics.of<LightPathFindings>().used());
    CHECK(samePilotPictures(byWork, renderByPilot(scene, size)));
    CHECK_FALSE(samePilotPictures(byWork, renderByPilot(scene, size == 4 ? 1 : size + 1)));
    const TestImage none = renderByPilot(scene, 0);
    CHECK(none.statistics.caustics.of<LightPathFindings>().verdict == LightPathVerdict::noPilot);
    CHECK(none.statistics.lightPaths == 0);
}

TEST_CASE("pilots: the frame is shown before anything is planned, and after each pass") {
    const TestScene scene = TestScene::parse(ballPictureText(20, 16));
    RecordingFilm film(scene.built().film, 2);
    const auto tracer = makePathTracer(scene.scene().effects);
    const RenderSettings settings = scene.settings();
    film.keepSplatsOf(*tracer, scene.scene(), settings);
    RenderState state(film.bounds(), 0, tracer->lightBlocks(scene.scene(), settings));
    int looks = 0, passes = 0;
    RenderControl control;
    control.state = &state;
    control.framePreview = [&](const FramePreview& look) {
        ++looks;
        CHECK(passes == 0);
        CHECK(state.reached() == 0);
        CHECK(state.pilot() == -1);
        CHECK(look.columns == 10);
        CHECK(look.cells.size() == 100);
        double mean = 0;
        for (const Xyz& xyz : look.cells) mean += xyz.y / 100;
        CHECK(mean > 0);
        CHECK(look.secondsForSample > 0);
    };
    control.passEnded = [&] {
        ++passes;
        CHECK(state.pilot() == RenderSettings::kFullPilot);
        CHECK(state.even());
    };
    tracer->render(scene.scene(), film, settings, control);
    CHECK(looks == 1);
    CHECK(passes == 3); // 2, 4 and 8 samples of each replicate
}

TEST_CASE("a time limit ends a render in time, whatever pilots and light paths would take") {
    const TestScene scene = TestScene::parse(ballPictureText(96, 1'000'000));
    RenderSettings settings = scene.settings();
    settings.pilot = RenderSettings::kPilotByWork;
    settings.timeLimit = 1;
    const TestImage image = renderAsProgram(scene, settings, 2);
    CHECK(image.statistics.seconds < 1.5);
    CHECK(image.statistics.seconds > 0.5);
    CHECK(image.statistics.pilotSeconds < 0.25); // a tenth, and what is in hand then
    CHECK(image.statistics.samplesPerPixel > 0);
    settings.timeLimit = 1e-3; // less than anything takes
    const TestImage least = renderAsProgram(scene, settings, 2);
    CHECK(least.statistics.seconds < 0.5);
    CHECK_FALSE(least.statistics.caustics.of<LightPathFindings>().used());
}

} // namespace abbe::test
