// Paths that surfaces take no light from are found before the first sample, and those surfaces; others that are long
// are not.
#include "light_sampling/light_sampler.h"
#include "path_tracing/path_kernels.h"
#include "render/integrator.h"
#include "render/render_state.h"
#include "rendering/look_ahead.h"
#include "support/scene_test.h"

#include <algorithm>
#include <doctest/doctest.h>
#include <numeric>

namespace abbe::test {
namespace {

LookAhead aheadOf(const TestScene& scene) {
    const LightSampler lights(scene.scene().lights);
    const PathContext context{scene.scene(), lights, scene.settings()};
    const RecordingFilm film(scene.built().film, 2);
    const RenderState state(film.bounds(), 0, 0);
    const TileFunction render = kernelFor(scene.scene().effects).render;
    return lookAhead(context, render, film, state, [] { return false; });
}

} // namespace

TEST_CASE("blocks of light paths are predicted to cost as much as a tile does") {
    const auto scene = TestScene::parse(R"(scene 1
render { samples 8 }
film { size 40 40 }
camera { from 0 1 4; look-at 0 0 0; fov 40 deg }
shape plane { material diffuse { reflectance 0.7 } }
light sky { luminance 100 nits }
)");
    REQUIRE(scene.report() == "");
    const RenderSettings settings = scene.settings();
    const LightSampler lights(scene.scene().lights, settings.technique.lightChoice);
    const PathContext context{scene.scene(), lights, settings};
    const RecordingFilm film(scene.built().film, 2);
    const auto costs = [&](std::size_t blocks) {
        const RenderState state(film.bounds(), 0, blocks);
        return lookAhead(context, kernelFor({}).render, film, state, [] { return false; }).tileCosts;
    };
    const std::vector<double> without = costs(0), with = costs(4);
    REQUIRE(without.size() == 9);
    REQUIRE(with.size() == 13);
    CHECK(std::equal(without.begin(), without.end(), with.begin()));
    const double mean = std::accumulate(without.begin(), without.end(), 0.0) / 9;
    CHECK(mean > 0);
    for (std::size_t i = 9; i < 13; ++i) CHECK(with[i] == doctest::Approx(mean));
}

// Where light comes in by the side that is seen, walks towards it find it; where it shines through, they miss it.
TEST_CASE("as many walks in solids are drawn towards the surface as find light there") {
    const auto shareOf = [](const std::string& rest) {
        const auto scene = TestScene::parse("scene 1\nfilm { size 64 64 }\n"
                                            "camera { from 0 0 4; look-at 0 0 0; fov 30 deg }\n"
                                            "material stone subsurface { reflectance 0.6; mean-free-path 5 cm; "
                                            "boundary diffuse }\n" +
                                            rest);
        REQUIRE(scene.report() == "");
        return aheadOf(scene).pulled.of(*scene.scene().media.front());
    };
    CHECK(shareOf("shape sphere { radius 1; material stone }\nlight sky") == 0.9f);
    CHECK(shareOf("shape box { min -2 -2 -0.1; max 2 2 0; material stone }\n"
                  "light quad { size 1 1; luminance 10000 nits; transform { look-at 0 0 -4  0 0 0 } }") <= 0.25f);
    // Nothing is known where nothing is seen.
    CHECK(shareOf("shape sphere { center 0 0 20; radius 1; material stone }\nlight sky") == PulledShares::kUnknown);
}

TEST_CASE("of lights behind a wall it is found that they do not arrive, and of others nothing is kept") {
    const auto arrivalOf = [](const std::string& rest) {
        const auto scene = TestScene::parse(
            "scene 1\nfilm { size 128 128 }\ncamera { from 0 9 0.1; look-at 0 0 0; fov 40 deg }\n"
            "shape floor quad { points -3 0 3  3 0 3  3 0 -3  -3 0 -3; material diffuse { reflectance 0.2 } }\n"
            "light sphere { center -1 1.5 0; radius 0.1; power 20 W }\n"
            "light sphere { center 1 1.5 0; radius 0.1; power 20 W }\n" +
            rest);
        REQUIRE(scene.report() == "");
        const LookAhead ahead = aheadOf(scene);
        const LightSampler lights(scene.scene().lights);
        const Vec3 left = Vec3(Vec3d(-1, 0, 0) - scene.scene().origin);
        const Receiver at(left, {0, 1, 0}, false);
        const LightArrival* const arrival = ahead.arrival ? &*ahead.arrival : nullptr;
        return std::pair(ahead.arrival.has_value(),
                         lights.probability(scene.scene().lights[1].get(), 0, at, {}, arrival) /
                             lights.probability(scene.scene().lights[1].get(), 0, at));
    };
    const auto [known, ratio] =
        arrivalOf("shape box { min -0.05 0 -3; max 0.05 3 3; material diffuse { reflectance 0.2 } }\n");
    CHECK(known);
    CHECK(ratio < 0.2f);
    CHECK(!arrivalOf("").first);
}

TEST_CASE("how open a scene is") {
    const auto openOf = [](const std::string& shapes) {
        const auto scene = TestScene::parse("scene 1\nfilm { size 40 40 }\nlight sky\n"
                                            "camera { from 0 1 0; look-at 0 0 -2; fov 60 deg }\n" +
                                            shapes);
        REQUIRE(scene.report() == "");
        return openness(scene.scene(), scene.scene().frame);
    };
    CHECK(openOf("") == 1);
    CHECK(openOf("shape plane { material diffuse }") == 1);
    CHECK(openOf("shape plane { material diffuse }\nshape plane { center 0 3 0; material diffuse }") == 0);
    // A wall sees the floor in half of its directions, and the floor before it sees the wall.
    const float half = openOf("shape plane { material diffuse }\n"
                              "shape plane { center 0 0 -6; normal 0 0 1; material diffuse }");
    CHECK(half > 0.4f);
    CHECK(half < 0.6f);
    // Boundaries of media are no surfaces.
    CHECK(
        openOf(
            "shape plane { material diffuse }\n"
            "shape sphere { center 0 1 0; radius 50; material boundary; interior homogeneous { scattering 0.1 per-m } "
            "}") == 1);
}

} // namespace abbe::test

namespace abbe::test {
namespace {

struct LookedAt {
    std::vector<std::string> shapes; // in order of names
    double rays = 0, share = 0;
};

LookedAt lookAtFrame(const std::string& text) {
    const auto scene = TestScene::parse("scene 1\nfilm { size 16 16 }\n" + text);
    REQUIRE(scene.report() == "");
    RenderSettings settings = scene.settings();
    settings.samples = 1;
    LookedAt seen;
    std::atomic<bool> stop = false;
    RenderControl control{&stop, {}};
    control.framePreview = [&](const FramePreview& look) {
        for (const Shape* shape : look.endless.shapes) seen.shapes.push_back(scene.scene().names.at(shape));
        seen.rays = look.raysOfPath;
        seen.share = look.endless.share;
        stop = true; // that was all
    };
    RecordingFilm film(scene.built().film, 1);
    makePathTracer(scene.scene().effects)->render(scene.scene(), film, settings, control);
    std::ranges::sort(seen.shapes);
    return seen;
}

const std::string kFacingMirrors = R"(
camera { from 0 0 0.9; look-at 0.02 0.01 -1; fov 50 deg }
light sphere { center 0 30 0; radius 1; radiance 1 }
shape far quad { points -4e3 -4e3 -1  4e3 -4e3 -1  4e3 4e3 -1  -4e3 4e3 -1; material conductor { index { n 0; k 5 } } }
shape near quad { points -4e3 -4e3 1  -4e3 4e3 1  4e3 4e3 1  4e3 -4e3 1; material conductor { index { n 0; k 5 } } }
)";

} // namespace

TEST_CASE("mirrors that face each other and reflect everything are named") {
    const LookedAt seen = lookAtFrame(kFacingMirrors);
    CHECK(seen.shapes == std::vector<std::string>{"far", "near"});
    CHECK(seen.rays > 100);
    CHECK(seen.share > 0.5);
}

TEST_CASE("a closed box that reflects everything is named, whatever its surface") {
    for (const std::string material : {"conductor { index { n 0; k 5 } }", "diffuse { reflectance 1 }"}) {
        CAPTURE(material);
        const LookedAt seen = lookAtFrame("camera { from 0.1 0.2 0.3; look-at 1 0.4 0.2; fov 50 deg }\n"
                                          "light sphere { center 0 0.8 0; radius 0.01; radiance 1 }\n"
                                          "shape room box { size 2 2 2; transform { scale 1 1 -1 }; material " +
                                          material + " }\n");
        CHECK(seen.shapes == std::vector<std::string>{"room"});
    }
}

TEST_CASE("long paths that lose light, and clear glass, are no such paths") {
    const LookedAt white = lookAtFrame("camera { from 0.1 0.2 0.3; look-at 1 0.4 0.2; fov 50 deg }\n"
                                       "light sphere { center 0 0.8 0; radius 0.01; radiance 1 }\n"
                                       "shape box { size 2 2 2; transform { scale 1 1 -1 }; material diffuse { "
                                       "reflectance 0.99 } }\n");
    CHECK(white.rays > 50);
    CHECK(white.shapes.empty());
    const LookedAt glass = lookAtFrame("camera { from 0 0 4; look-at 0 0 0; fov 30 deg }\nlight sky { radiance 1 }\n"
                                       "shape sphere { material dielectric { ior 1.5 } }\n");
    CHECK(glass.rays < 30);
    CHECK(glass.shapes.empty());
}

} // namespace abbe::test
