// What manifold sampling leaves to merging.
#include "film/film_params.h"
#include "film/pixel_film.h"
#include "support/scene_test.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

LightPathFindings planned(const char* file, Technique::Merging merging) {
    const TestScene scene = TestScene::load(file);
    REQUIRE(scene.report() == "");
    const FilmSettings s = filmSettings(scene.built().film);
    const auto tracer = makePathTracer(scene.scene().effects);
    RenderSettings settings = scene.settings();
    settings.technique.merging = merging;
    PixelFilm film(s.crop, PixelFilter(s.filter, s.filterRadius), 2);
    film.keepSplatsOf(*tracer, scene.scene(), settings);
    return tracer->findLightPaths(scene.scene(), film, settings);
}

} // namespace

// The facets of the stone lead a hundredth of all first directions to the lamp: the pilot finds next to nothing.
TEST_CASE("manifold sampling: chains that are hardly ever found are left to merging, if there is any") {
    const LightPathFindings both = planned("scenes/diamond/diamond.scene", Technique::Merging::automatic);
    CHECK(both.merging.used);
    CHECK(both.manifold.chains < 8);
    CHECK(both.manifold.leftToMerging);
    CHECK_FALSE(both.manifold.used);
    const LightPathFindings alone = planned("scenes/diamond/diamond.scene", Technique::Merging::off);
    CHECK_FALSE(alone.merging.used);
    CHECK_FALSE(alone.manifold.leftToMerging);
    CHECK(alone.manifold.used);
}

TEST_CASE("manifold sampling: chains that are often found stay, beside merging") {
    const LightPathFindings both = planned("scenes/mirror-caustic/mirror-caustic.scene", Technique::Merging::automatic);
    CHECK(both.merging.used);
    CHECK(both.manifold.chains > 50);
    CHECK(both.manifold.used);
    CHECK_FALSE(both.manifold.leftToMerging);
}

} // namespace abbe::test
