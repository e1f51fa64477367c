// Plans of samples: their ranges, what they make of a pilot, and that the bits of a render do not depend on how it is
// cut.
#include "render/render_state.h"
#include "rendering/sampling_plan.h"
#include "rendering/time_left.h"
#include "support/same_bits.h"
#include "support/scene_test.h"

#include <doctest/doctest.h>
#include <functional>
#include <optional>

namespace abbe::test {
namespace {

// Noise and cost of a sample by place in the frame, from 0 to 1; each look sees them with errors of so many per cent,
// on one side or the other.
struct Truth {
    std::function<double(double, double)> variance = [](double, double) { return 1.0; };
    std::function<double(double, double)> rays = [](double, double) { return 5.0; };
    std::function<double(double, double)> luminance = [](double, double) { return 1.0; };
    std::function<double(Random&)> error = [](Random& r) { return -std::log(r.uniformDouble()); }; // mean 1
};

// Two replicates whose means differ by what makes this variance of one sample.
void fill(PlanPilot::Probe& probe, double luminance, double variance) {
    const double n = PlanPilot::kSamples, half = std::sqrt(variance / (2 * n));
    for (int r = 0; r < 2; ++r) {
        const Xyz sum{0, n * (luminance + (r == 0 ? half : -half)), 0};
        probe.add(0, 0, r, ExactXyz(sum), PlanPilot::kSamples);
    }
}

PlanPilot pilotOf(PixelBounds frame, const Truth& truth, std::uint64_t seed = 1) {
    PlanPilot pilot(frame, seed);
    Random random(seed);
    const PixelFilm film({0, 0, 1, 1}, PixelFilter(FilterShape::box, 0.5), 1);
    for (int row = 0; row < pilot.rows(); ++row)
        for (int column = 0; column < pilot.columns(); ++column)
            for (int look = 0; look < PlanPilot::kLooks; ++look) {
                const PixelBounds p = pilot.pixelOf(column, row, look);
                const double u = (p.x0 - frame.x0 + 0.5) / frame.width(), v = (p.y0 - frame.y0 + 0.5) / frame.height();
                PlanPilot::Probe probe(p, film);
                fill(probe, truth.luminance(u, v), truth.variance(u, v) * truth.error(random));
                pilot.add(column, row, look, probe,
                          static_cast<std::uint64_t>(truth.rays(u, v) * PlanPilot::kSamples * PlanPilot::kReplicates));
            }
    return pilot;
}

// Over those of even samples.
struct Worth {
    double cost = 0, error = 0;
};
Worth worthOf(const SamplingPlan& plan, PixelBounds frame, const Truth& truth) {
    double cost = 0, evenCost = 0, error = 0, evenError = 0;
    for (int y = frame.y0; y < frame.y1; ++y)
        for (int x = frame.x0; x < frame.x1; ++x) {
            const double u = (x - frame.x0 + 0.5) / frame.width(), v = (y - frame.y0 + 0.5) / frame.height();
            const double factor = std::ldexp(1.0, plan.exponent(x, y));
            const double e = truth.variance(u, v) / square(truth.luminance(u, v));
            evenCost += truth.rays(u, v);
            cost += truth.rays(u, v) * factor;
            evenError += e;
            error += e / factor;
        }
    return {cost / evenCost, error / evenError};
}

const PixelBounds kPlanFrame{0, 0, 320, 200};

} // namespace

TEST_CASE("plan: the ranges of passes and of parts hold each sample once, and powers of two stay aligned") {
    for (int k = SamplingPlan::kLeast; k <= SamplingPlan::kMost; ++k) {
        const auto last = [k](std::uint32_t n) { return SamplingPlan::scaled({0, n}, k).last; };
        CAPTURE(k);
        for (const std::uint32_t whole : {1u, 2u, 3u, 23u, 64u, 100u, 4096u})
            for (const std::uint32_t parts : {1u, 2u, 3u, 7u, 40u}) {
                std::uint32_t next = 0;
                for (std::uint32_t part = 1; part <= parts; ++part) {
                    const RenderSettings settings{.samples = whole, .part = part, .parts = parts};
                    for (std::uint32_t first = settings.range(1).first; first < settings.range(1).last;) {
                        const std::uint32_t end = std::min(endOfPassWith(first), settings.range(1).last);
                        const SampleRange range = SamplingPlan::scaled({first, end}, k);
                        REQUIRE(range.first == next);
                        REQUIRE(range.last >= range.first);
                        next = range.last;
                        first = end;
                    }
                }
                CHECK(next == last(whole));
                CHECK(next == static_cast<std::uint32_t>(std::ceil(std::ldexp(whole, k))));
            }
        for (std::uint32_t size = 1; size <= 256; size *= 2)
            for (std::uint32_t block = 0; block < 9; ++block) {
                const SampleRange range = SamplingPlan::scaled({block * size, (block + 1) * size}, k);
                const std::uint32_t length = range.last - range.first;
                CHECK(length <= std::max(1u, static_cast<std::uint32_t>(std::ldexp(size, k))));
                if (length == 0) continue;
                CHECK((length & (length - 1)) == 0);
                CHECK(range.first % length == 0);
            }
        CHECK(last(1) >= 1);
    }
    CHECK(SamplingPlan::scaled({1u << 31, 0xffffffff}, 3).first == 0xffffffff); // not beyond what can be counted
    CHECK(SamplingPlan::scaled({1u << 31, 0xffffffff}, 3).last == 0xffffffff);
}

TEST_CASE("plan: an even frame is sampled evenly, however noisy the looks at it are") {
    CHECK(SamplingPlan(pilotOf(kPlanFrame, {})).even());
    Truth specks; // one look in a hundred has nearly all of the variance
    specks.error = [](Random& r) { return r.uniform() < 0.01f ? 100.0 : 0.01; };
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
        const SamplingPlan plan(pilotOf(kPlanFrame, specks, seed));
        if (!plan.even()) CHECK(worthOf(plan, kPlanFrame, {}).error < 1.1);
    }
    Truth dark;
    dark.variance = dark.luminance = [](double, double) { return 0.0; };
    CHECK(SamplingPlan(pilotOf(kPlanFrame, dark)).even());
    CHECK(SamplingPlan(pilotOf({0, 0, 1, 1}, {})).exponent(0, 0) == 0);
}

TEST_CASE("plan: where noise is uneven, an equal cost makes less of it, about as little as can be") {
    Truth truth; // a tenth of the frame has a hundred times the variance
    truth.variance = [](double u, double v) { return u < 0.3 && v < 0.33 ? 100.0 : 1.0; };
    const SamplingPlan plan(pilotOf(kPlanFrame, truth));
    REQUIRE_FALSE(plan.even());
    const Worth worth = worthOf(plan, kPlanFrame, truth);
    CHECK(worth.cost == doctest::Approx(1).epsilon(0.03));
    // (Σ √v)² / Σ v without limits of the factor and powers of two: (0.1·10 + 0.9)²/(0.1·100 + 0.9) = 0.33.
    CHECK(worth.error < 0.45);
    for (int y = 0; y < 200; ++y)
        for (int x = 0; x < 320; ++x)
            REQUIRE((plan.exponent(x, y) >= SamplingPlan::kLeast && plan.exponent(x, y) <= SamplingPlan::kMost));
    CHECK(plan.exponent(40, 30) >= plan.exponent(250, 150) + 3);
}

TEST_CASE("plan: dear samples are taken less often, and dark places count as much as bright ones") {
    Truth dear;
    dear.rays = [](double u, double) { return u < 0.5 ? 2.0 : 64.0; };
    const SamplingPlan plan(pilotOf(kPlanFrame, dear));
    REQUIRE_FALSE(plan.even());
    CHECK(plan.exponent(40, 100) >= plan.exponent(280, 100) + 2);
    CHECK(worthOf(plan, kPlanFrame, dear).cost == doctest::Approx(1).epsilon(0.05));
    Truth shaded; // the same relative noise
    shaded.luminance = [](double u, double) { return u < 0.5 ? 1.0 : 4.0; };
    shaded.variance = [](double u, double) { return u < 0.5 ? 1.0 : 16.0; };
    const SamplingPlan alike(pilotOf(kPlanFrame, shaded));
    CHECK(alike.exponent(40, 100) == alike.exponent(280, 100));
}

TEST_CASE("plan: its looks are at pixels of the frame, two of each half in each cell, by frame and seed alone") {
    for (const PixelBounds frame :
         {PixelBounds{0, 0, 1, 1}, {0, 0, 37, 21}, {0, 0, 641, 9}, {0, 0, 65536, 1}, {0, 0, 7680, 4320}}) {
        const PlanPilot pilot(frame, 7), again(frame, 7);
        CHECK(pilot.columns() * pilot.rows() <= 8192);
        for (int row = 0; row < pilot.rows(); ++row)
            for (int column = 0; column < pilot.columns(); ++column)
                for (int look = 0; look < PlanPilot::kLooks; ++look) {
                    const PixelBounds p = pilot.pixelOf(column, row, look);
                    REQUIRE((p.area() == 1 && p.x0 >= frame.x0 && p.y0 >= frame.y0 && p.x1 <= frame.x1 &&
                             p.y1 <= frame.y1));
                    REQUIRE((p.x0 / pilot.cellSize() == column && p.y0 / pilot.cellSize() == row));
                    REQUIRE(again.pixelOf(column, row, look).x0 == p.x0);
                }
    }
}

// A small light seen through a rough ball in one corner; the rest is a quiet sky.
const char* const kUneven = R"(scene 1
film { size 72 48 }
camera { from 0 0.9 4; look-at 0.6 0.4 0; fov 40 deg }
shape sphere { center 0 0.5 0; radius 0.5; material dielectric { ior 1.5; roughness 0.3 } }
shape quad { size 2 2; material diffuse { reflectance 0.6 }; transform { rotate x -90 deg } }
light sphere { center -1 2 0; radius 0.02; power 4000 lm }
light sky { luminance 300 nits }
)";

// A pilot of so small a frame may see no difference: the first seed for which it does.
std::optional<std::uint64_t> seedOfUnevenPlan(const TestScene& scene, RenderSettings settings) {
    settings.adaptive = true;
    for (settings.seed = 0; settings.seed < 8; ++settings.seed) {
        const TestImage image = render(scene, settings, {}, 2);
        for (int y = 0; y < 48; ++y)
            for (int x = 0; x < 72; ++x)
                if (2 * image.film.replicate(x, y, 0).second != settings.samples) return settings.seed;
    }
    return std::nullopt;
}

TEST_CASE("adaptive: crops, parts and interrupted renders take the samples of the whole, and they are uneven") {
    const auto scene = TestScene::parse(kUneven);
    REQUIRE(scene.report() == "");
    RenderSettings settings = scene.settings();
    settings.samples = 46;
    const auto seed = seedOfUnevenPlan(scene, settings);
    REQUIRE(seed);
    settings.seed = *seed;
    const TestImage even = render(scene, settings, {}, 2);
    settings.adaptive = true;
    const TestImage whole = render(scene, settings, {}, 2);
    std::uint32_t least = 1000, most = 0;
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 72; ++x) {
            const std::uint32_t n = whole.film.replicate(x, y, 0).second;
            REQUIRE(n == whole.film.replicate(x, y, 1).second);
            least = std::min(least, n);
            most = std::max(most, n);
            // Pixels that take as many as before take the same.
            if (n == 23) REQUIRE(whole.film.replicate(x, y, 0).first.y == even.film.replicate(x, y, 0).first.y);
        }
    CHECK(least < 23);
    CHECK(most > 23);
    CHECK(whole.statistics.pilotRays > even.statistics.pilotRays);
    CHECK(static_cast<double>(whole.statistics.rays()) ==
          doctest::Approx(static_cast<double>(even.statistics.rays())).epsilon(0.15));

    const auto tracer = makePathTracer(scene.scene().effects);
    RecordingFilm film(scene.built().film, 2);
    for (settings.part = 1, settings.parts = 3; settings.part <= 3; ++settings.part)
        tracer->render(scene.scene(), film, settings, {});
    CHECK(sameBits(whole.film, film));
    settings.part = settings.parts = 1;

    FilmSettings cropped = filmSettings(scene.built().film);
    cropped.crop = {13, 5, 50, 40};
    RecordingFilm crop(cropped, 2);
    tracer->render(scene.scene(), crop, settings, {});
    for (int y = 5; y < 40; ++y)
        for (int x = 13; x < 50; ++x) {
            REQUIRE(crop.replicate(x, y, 1).second == whole.film.replicate(x, y, 1).second);
            REQUIRE(crop.replicate(x, y, 1).first.y == whole.film.replicate(x, y, 1).first.y);
        }

    RecordingFilm continued(scene.built().film, 2);
    RenderState state(continued.bounds(), 0);
    for (const std::uint32_t samples : {1u, 6u, 20u, 46u}) {
        settings.samples = samples;
        tracer->render(scene.scene(), continued, settings, {nullptr, {}, &state});
    }
    CHECK(sameBits(whole.film, continued));
}

} // namespace abbe::test
