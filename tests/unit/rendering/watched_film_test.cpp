#include "caustics/glints/glint_plan.h"
#include "caustics/light_tracing/light_path_plan.h"
#include "caustics/merging/merge_plan.h"
#include "film/pixel_film.h"
#include "rendering/path_record.h"
#include "support/scene_test.h"

#include <doctest/doctest.h>

namespace abbe::test {

TEST_CASE("watched film: the pixel filter and what is kept are those of the film that it stands for") {
    PixelFilm film({0, 0, 2, 2}, PixelFilter(FilterShape::gaussian, 1.5), 1);
    film.keepSplats();
    film.keepMerged();
    const WatchedFilm watched(film, {});
    CHECK(watched.filterRadius() == 1.5f);
    for (const float offset : {0.f, 0.4f, 1.2f, 1.6f}) CHECK(watched.filterWeight(offset) == film.filterWeight(offset));
    CHECK(watched.filter({0.9f, 0.2f}).offset.x == film.filter({0.9f, 0.2f}).offset.x);
    CHECK(watched.takesSplats());
    CHECK(watched.takesMerged());
}

// Which light samples leave to light paths, to manifold sampling, to merging and to probes of glints follows from
// plans, and plans ask the film: a sample that is repeated has to meet the same ones.
TEST_CASE("watched film: repeated samples have the light that they had, beside glints and merged light") {
    const TestScene scene = TestScene::parse(R"(scene 1
film { size 24 18; filter gaussian }
render { max-depth 6; light-paths always; merging always; replicates 2 }
camera { from 0 0.4 6; look-at 0 0 0; fov 40 deg }
object bead { shape sphere { radius 1.3; material dielectric { ior 1.6 } } }
instance bead
shape plane { center 0 -1.4 0; material diffuse { reflectance 0.5 } }
light sphere { center 0 5 0; radius 1; radiance 10 }
light sun { elevation 40 deg; azimuth 150 deg; irradiance 1 klx; angular-diameter 2 deg }
)");
    constexpr std::uint32_t kEach = 24; // samples of a replicate
    RenderSettings settings = scene.settings();
    settings.samples = 2 * kEach;
    settings.adaptive = false;
    const FilmSettings s = filmSettings(scene.built().film);
    PixelFilm film(s.crop, PixelFilter(s.filter, s.filterRadius), 2);
    const auto tracer = makePathTracer(scene.scene().effects);
    film.keepSplatsOf(*tracer, scene.scene(), settings);
    const CausticFindings plan = tracer->render(scene.scene(), film, settings, {}).caustics;
    REQUIRE(plan.of<LightPathFindings>().verdict == LightPathVerdict::requested);
    REQUIRE(plan.of<MergeFindings>().used);
    REQUIRE(plan.of<GlintFindings>().found > 0);
    std::vector<SampleId> all;
    for (int y = 0; y < 18; ++y)
        for (int x = 0; x < 24; ++x)
            for (int r = 0; r < 2; ++r)
                for (std::uint32_t i = 0; i < kEach; ++i) all.push_back({x, y, r, i});
    WatchedFilm watched(film, all);
    tracer->repeat(scene.scene(), watched, settings, all);
    REQUIRE(watched.records().size() == all.size());
    int unlike = 0;
    for (std::size_t i = 0; i < all.size(); i += 2 * kEach) {
        Xyz sum{};
        for (std::size_t k = i; k < i + 2 * kEach; ++k) sum += watched.records()[k].xyz();
        const Xyz mean = film.sampleMean(all[i].x, all[i].y, 0, 2);
        unlike += std::abs(sum.y / (2 * kEach) - mean.y) > 1e-12 * mean.y;
    }
    CHECK(unlike == 0);
}

} // namespace abbe::test
