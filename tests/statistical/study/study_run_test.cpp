// Whole studies of small scenes: what theory says about their curves, and that their images are those of renders.
#include "study/study_report.h"
#include "study/study_run.h"
#include "support/scene_test.h"

#include <doctest/doctest.h>
#include <map>

using namespace abbe;
using test::TestScene;

namespace {

// A light over a floor, all of it lit: no edge of a shadow, so that points beat random numbers by far.
constexpr const char* kSmooth = R"(scene 1
camera { from 0 2 2.5; look-at 0 0 0; fov 30 deg }
film   { size 16 16 }
render { samples 16 }
material white diffuse { reflectance 0.5 }
light lamp quad { points -0.5 2 -0.5  0.5 2 -0.5  0.5 2 0.5  -0.5 2 0.5; luminance 1000 nits }
shape floor quad { material white; points -4 0 4  4 0 4  4 0 -4  -4 0 -4 }
)";

struct MemoryStore {
    std::map<std::string, CurveRecord> curves;
    std::optional<StoredReference> reference;

    StudyStore store() {
        return {[this](const std::string& id) {
                    const auto found = curves.find(id);
                    return found == curves.end() ? std::nullopt : std::optional(found->second);
                },
                [this](const CurveRecord& record) { curves[record.id] = record; }, [this] { return reference; },
                [this](const StoredReference& r) { reference = r; }};
    }
};

StudySubject subjectOf(const TestScene& scene) {
    scene.scene(); // throws on errors
    StudySubject subject;
    subject.built = &scene.built();
    subject.film = filmSettings(scene.built().film);
    subject.settings = scene.settings();
    subject.replicates = static_cast<int>(scene.built().render.replicates);
    return subject;
}

struct Studied {
    StudyReport report;
    MemoryStore memory;
};

Studied study(const StudySubject& subject, std::vector<std::string> variants, std::uint32_t samples, int seeds = 8) {
    StudyPlan plan;
    plan.chosen = chooseVariants(subject, variants);
    plan.samples = samples;
    plan.seeds = seeds;
    Studied result;
    const StudyStore store = result.memory.store();
    REQUIRE(StudyRun(subject, plan, store, {}).run() == StudyEnd::done);
    result.report = StudyReport::make(subject, plan, store);
    return result;
}

const StudyCurve& curve(const StudyReport& report, const std::string& id) {
    for (const StudyCurve& c : report.curves)
        if (c.variant.id == id) return c;
    throw std::runtime_error("no curve " + id);
}

} // namespace

TEST_CASE("random numbers converge like 1/N, points faster") {
    const auto scene = TestScene::parse(kSmooth);
    const StudyReport report = study(subjectOf(scene), {"random"}, 128).report;
    const Estimate random = curve(report, "random").statistics.slope();
    INFO("random ", random.value, " from ", random.low, " to ", random.high);
    CHECK(random.low <= -1);
    CHECK(random.high >= -1);
    CHECK(random.high - random.low < 0.2); // so that it says something
    const Estimate points = curve(report, "abbe").statistics.slope();
    INFO("points ", points.value, " from ", points.low, " to ", points.high);
    CHECK(points.high < -1);
    CHECK(report.referenceAdvantage >= StudyRun::kReferenceAdvantage);
    // Random numbers have more of an error at the same time.
    CHECK(
        curve(report, "random").statistics.efficiencyAgainst(curve(report, "abbe").statistics, TimeBasis::whole).high <
        1);
    // Neither is biased.
    for (const StudyCurve& c : report.curves) {
        const Estimate bias = c.bias.back();
        REQUIRE(c.statistics.error(c.statistics.rungs() - 1).value > 0);
        CHECK(std::abs(bias.value) < 0.2 * c.statistics.error(c.statistics.rungs() - 1).value);
    }
}

TEST_CASE("the image of a rung is that of a render") {
    const auto scene = TestScene::load("tests/cli/scenes/room.scene");
    const StudySubject subject = subjectOf(scene);
    const StudyVariant main = studyVariants()[0];
    LadderRender ladder(subject, main, 7, nullptr);
    std::optional<LadderRung> rung;
    for (const std::uint32_t n : {2u, 4u, 16u}) rung = ladder.advance(n);
    REQUIRE(rung);
    LadderRender direct(subject, main, 7, nullptr);
    const auto whole = direct.advance(16);
    REQUIRE(whole);
    CHECK(rung->samples == 32);
    CHECK(rung->image.rgb == whole->image.rgb);
    // What later looks ahead took is not counted: the same rays.
    CHECK(rung->cost.rays == whole->cost.rays);
    RenderSettings settings = subject.settings;
    settings.samples = 32;
    settings.seed = 7;
    PixelFilm film({0, 0, subject.film.width, subject.film.height},
                   PixelFilter(subject.film.filter, subject.film.filterRadius), subject.replicates);
    const RenderStatistics s = makePathTracer(scene.scene().effects)->render(scene.scene(), film, settings, {});
    CHECK(rung->cost.rays == s.rays() + s.pilotRays);
    const ResolvedImage image =
        film.resolve(rgbSpace(subject.film.space).fromXyz() * subject.film.whiteBalance, scene.built().exposure);
    bool same = true;
    for (std::size_t i = 0; i < image.r.size(); ++i)
        same = same && image.r[i] == rung->image.rgb[3 * i] && image.b[i] == rung->image.rgb[3 * i + 2];
    CHECK(same);
}

// Strata are as many as there will be samples, so a rung with fewer of them has other samples: it is no part of a
// longer render.
TEST_CASE("rungs of strata are renders of their own") {
    const auto scene = TestScene::load("tests/cli/scenes/room.scene");
    const StudySubject subject = subjectOf(scene);
    const ChosenVariants chosen = chooseVariants(subject, {"stratified"});
    REQUIRE(chosen.variants.size() == 2);
    LadderRender ladder(subject, chosen.variants[1], 7, nullptr), direct(subject, chosen.variants[1], 7, nullptr);
    const auto first = ladder.advance(4), rung = ladder.advance(16), whole = direct.advance(16);
    REQUIRE(rung);
    CHECK(rung->image.rgb == whole->image.rgb);
    CHECK(rung->cost.rays == whole->cost.rays); // without those of the first rung
    CHECK(rung->image.rgb != first->image.rgb);
}

TEST_CASE("a denoised curve is better and biased") {
    const auto scene = TestScene::load("tests/cli/scenes/room.scene", [] {
        BuildOptions options;
        options.size = Vec2i{64, 48};
        return options;
    }());
    const StudyReport report = study(subjectOf(scene), {"denoised"}, 32).report;
    const StudyCurve &main = curve(report, "abbe"), &denoised = curve(report, "denoised");
    CHECK(denoised.statistics.error(1).high < main.statistics.error(1).low);
    CHECK(denoised.bias[1].low > 0);
    CHECK(main.bias[1].low < 0);
    CHECK(denoised.statistics.seconds(1) > main.statistics.seconds(1));
    // Pictures of all curves at each time.
    REQUIRE(report.strips.size() >= 2);
    for (const StudyStrip& strip : report.strips) {
        REQUIRE(strip.pictures.size() == 2);
        CHECK(strip.pictures[0].png.size() > 1000);
    }
}

TEST_CASE("variants that make no difference are left out") {
    const auto scene = TestScene::parse(std::string(kSmooth));
    std::vector<std::string> all;
    for (const StudyVariant& v : studyVariants()) all.emplace_back(v.id);
    const ChosenVariants chosen = chooseVariants(subjectOf(scene), all);
    const auto leftOut = [&](const ChosenVariants& c, std::string_view id) {
        for (const LeftOutVariant& v : c.leftOut)
            if (v.id == id) return !v.reason.empty();
        return false;
    };
    CHECK(leftOut(chosen, "light-power")); // one light
    CHECK_FALSE(leftOut(chosen, "sobol")); // as it is, and nobody asked
    CHECK(leftOut(chooseVariants(subjectOf(scene), {"sobol"}), "sobol"));
    for (const StudyVariant& v : chosen.variants) CHECK(std::string_view(v.id) != "sobol");
    CHECK_FALSE(leftOut(chosen, "random"));
    CHECK_FALSE(leftOut(chosen, "no-nee"));
    // With a light that cannot be met by chance, and one more to choose from.
    const auto lit = TestScene::parse(std::string(kSmooth) + "light bulb point { position 1 1 1; power 10 W }\n");
    const ChosenVariants more = chooseVariants(subjectOf(lit), all);
    CHECK(leftOut(more, "no-nee"));
    CHECK_FALSE(leftOut(more, "light-power"));
    // Where nothing focuses light there is nothing to compare; else what the scene does not do anyway.
    CHECK(leftOut(chosen, "light-paths-off"));
    CHECK(leftOut(chosen, "light-paths-always"));
    const auto glass = TestScene::parse(
        std::string(kSmooth) + "shape ball sphere { center 0 0.5 0; radius 0.2; material dielectric { ior 1.5 } }\n"
                               "light spark sphere { center 2 2.5 0; radius 1 mm; power 2000 lm }\n");
    const ChosenVariants caustic = chooseVariants(subjectOf(glass), all);
    CHECK_FALSE(leftOut(caustic, "light-paths-off"));
    CHECK(leftOut(caustic, "light-paths-always"));
    const auto single = TestScene::parse(std::string(kSmooth).replace(std::string(kSmooth).find("samples 16"), 10,
                                                                      "samples 16; replicates 1; sampler random"));
    const ChosenVariants other = chooseVariants(subjectOf(single), all);
    CHECK(leftOut(other, "denoised"));
    CHECK_FALSE(leftOut(other, "sobol"));
}
