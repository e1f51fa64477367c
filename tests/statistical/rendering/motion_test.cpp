// Pictures of what moves: against the mean of still ones, against the inverse motion of the camera, and between
// estimators that know where a moving light is and one that only meets it.
#include "support/scene_test.h"
#include "support/scene_test_compare.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

constexpr const char* kMotionHeader = "scene 1\nfilm { size 16 16; filter box 0.5 }\n";

// Relative error with which a comparison still says something: by day a quarter of the samples are rendered.
const double kSeen = nightly() ? 0.006 : 0.012;

TestImage renderWith(const std::string& text, Technique::Strategy strategy, std::uint32_t samples, std::uint64_t seed) {
    BuildOptions options;
    options.strategy = strategy;
    const auto scene = TestScene::parse(kMotionHeader + text, options);
    RenderSettings settings = scene.settings();
    settings.samples = nightly() ? samples : std::max(8u, samples / 4);
    settings.maxDepth = 3;
    settings.seed = seed;
    return render(scene, settings);
}

// The mean over the shutter interval [0, 1] s of pictures without a shutter.
ImageComparison againstStills(const std::string& body, std::uint32_t samples) {
    constexpr int count = 192; // shadows move by less than a pixel between two
    const std::string eye = "camera { from 0 0.5 4; look-at 0 0 0; fov 40 deg; ";
    const TestImage moving = renderWith(eye + "shutter 1 s }\n" + body, Strategy::mis, samples, 1);
    std::vector<TestImage> stills;
    for (int i = 0; i < count; ++i)
        stills.push_back(renderWith(eye + fmt::format("time {} s }}\n", (i + 0.5) / count) + body, Strategy::mis,
                                    std::max(16u, samples / count), static_cast<std::uint64_t>(i) + 2));
    return compareTiles(
        moving.film.bounds(), 4, [&](PixelBounds t) { return moving.film.tile(t); },
        [&](PixelBounds t) {
            Estimate sum{0, 0, 7. * count};
            for (const TestImage& still : stills) {
                const Estimate e = still.film.tile(t);
                sum.mean += e.mean / count;
                sum.variance += e.variance / (count * count);
            }
            return sum;
        });
}

void check(const ImageComparison& c) {
    INFO(c.text());
    CHECK(c.same());
    CHECK(c.error < kSeen);
}

const std::string kFloor = "shape floor quad { points -4 -1 4  4 -1 4  4 -1 -4  -4 -1 -4 }\n"
                           "shape ball sphere { center 0.5 -0.6 0; radius 0.4 }\n";
const std::string kTurn =
    "transform { at 0 s { rotate z 0 deg; translate -0.5 0 0 }\n"
    "at 0.5 s { rotate z 100 deg; translate 0 0.2 0 }\nat 1 s { rotate z 170 deg; translate 0.6 0 0 } }";

} // namespace

TEST_CASE("motion: a moving shape is the mean of the shapes that stand still") {
    check(againstStills(kFloor + "light sky { radiance 1 }\nshape box { size 1.2 0.3 0.3; " + kTurn + " }\n", 4096));
}

TEST_CASE("motion: a moving group with a light in it, a light that grows, and a light point") {
    check(againstStills(kFloor + "group { " + kTurn +
                            "\nshape box { size 1 0.2 0.2 }\n"
                            "light quad { points -0.3 0.4 -0.3  0.3 0.4 -0.3  0.3 0.4 0.3  -0.3 0.4 0.3; radiance 2; "
                            "two-sided on } }\n",
                        32768));
    check(againstStills(kFloor +
                            "light sphere { center 0 0.5 0; radius 0.2; radiance 3; transform { at 0 s { scale 0.5 }\n"
                            "at 1 s { scale 2; translate 0.5 0 0 } } }\n",
                        8192));
    check(againstStills(kFloor + "light point { position 0 1 0; intensity 100 cd; transform { at 0 s { scale 1 }\n"
                                 "at 1 s { scale 2; translate 1 0 0 } } }\n",
                        2048));
}

TEST_CASE("motion: a sun and a spot that turn") {
    check(againstStills(kFloor + "light sun { toward 0.3 -1 0; angular-diameter 20 deg; irradiance 1000 lx; transform "
                                 "{ at 0 s { rotate z 0 deg }\n"
                                 "at 1 s { rotate z 60 deg } } }\n",
                        4096));
    check(againstStills(kFloor + "light spot { position 0 2 0; look-at 0 0 0; angle 30 deg; intensity 100 cd; "
                                 "transform { at 0 s { rotate z -20 deg }\n"
                                 "at 1 s { rotate z 30 deg } } }\n",
                        2048));
}

TEST_CASE("motion: strategies agree on lights that move") {
    const std::string eye = "camera { from 0 0.5 4; look-at 0 0 0; fov 40 deg; shutter 1 s }\n";
    for (const std::string& light : std::initializer_list<std::string>{
             "light quad { points -0.5 0.9 -0.5  0.5 0.9 -0.5  0.5 0.9 0.5  -0.5 0.9 0.5; radiance 2; two-sided on; " +
                 kTurn + " }\n",
             "light sphere { radius 0.4; radiance 2; transform { at 0 s { scale 0.5; translate -0.8 0.5 0 }\nat 1 s { "
             "scale 1.5; translate 0.8 0.5 0 } } }\n",
             "group { " + kTurn + "\nshape box { size 0.8 0.3 0.5; emission 2 } }\n",
             "light sun { toward 0.3 -1 0; angular-diameter 40 deg; irradiance 1000 lx; transform { at 0 s { rotate z "
             "0 deg }\nat 1 s { rotate z 60 deg } } }\n",
         }) {
        INFO(light);
        const std::string text = eye + kFloor + light;
        const TestImage mis = renderWith(text, Strategy::mis, 2048, 1),
                        lights = renderWith(text, Strategy::lightsOnly, 2048, 2),
                        bsdf = renderWith(text, Strategy::bsdfOnly, 8192, 3);
        for (const ImageComparison& c :
             {compareImages(lights.film, mis.film, Channel::y, 4), compareImages(bsdf.film, mis.film, Channel::y, 4)}) {
            INFO(c.text());
            CHECK(c.same());
            CHECK(c.error < kSeen);
        }
    }
}

TEST_CASE("motion: a camera that turns is a world that turns the other way") {
    const auto with = [](const char* camera, const char* world) {
        return renderWith(
            fmt::format("camera {{ fov 40 deg; shutter 1 s; transform {{ {} }} }}\ngroup {{ transform {{ {} }}\n"
                        "shape floor quad {{ points -4 -1 4  4 -1 4  4 -1 -4  -4 -1 -4 }}\n"
                        "shape box {{ size 1 1 1; transform {{ translate 0.5 -0.5 0 }} }}\n"
                        "light quad {{ points -1 1.5 -1  1 1.5 -1  1 1.5 1  -1 1.5 1; radiance 2 }} }}\n",
                        camera, world),
            Strategy::mis, 2048, camera[0] == 'a' ? 1 : 2);
    };
    // Like steps on both sides, so that one is the inverse of the other at all times.
    const TestImage camera = with("at 0 s { translate 0 0 5; rotate y 0 deg; translate 0 0 0 }\n"
                                  "at 1 s { translate 0 0 5; rotate y -25 deg; translate 0 0.4 0 }",
                                  "scale 1"),
                    world = with("translate 0 0 5", "at 0 s { translate 0 0 0; rotate y 0 deg }\n"
                                                    "at 1 s { translate 0 -0.4 0; rotate y 25 deg }");
    const ImageComparison c = compareImages(camera.film, world.film, Channel::y, 4);
    INFO(c.text());
    CHECK(c.same());
    CHECK(c.error < kSeen);
}

// A bright half plane whose edge crosses the picture: a pixel is lit from when the edge has passed it.
TEST_CASE("motion: a moving edge shows the transmission of the shutter") {
    for (const auto& [opening, closing] : {std::pair{0.0, 0.0}, {0.5, 0.0}, {0.3, 0.9}, {1.0, 1.0}}) {
        const double length = 1 + 0.5 * (opening + closing);
        const std::string text = fmt::format(
            "camera orthographic {{ from 0 0 5; look-at 0 0 0; width 2; shutter 1 s {{ opening {}; closing {} }} }}\n"
            "shape quad {{ emission 1; points -9 -2 0  -0.75 -2 0  -0.75 2 0  -9 2 0; transform {{ at 0 s {{ translate "
            "0 0 0 }}\n"
            "at {} s {{ translate 1.5 0 0 }} }} }}\n",
            opening, closing, length);
        const TestImage image = renderWith(text, Strategy::bsdfOnly, 8192, 5);
        const double full = image.film.tile({0, 0, 1, 16}).mean;
        const auto later = [&](double t) { // the part of the light that comes after t
            const auto transmission = [&](double s) {
                double v = s < 0 || s > length ? 0 : 1;
                if (opening > 0) v = std::min(v, s / opening);
                if (closing > 0) v = std::min(v, (length - s) / closing);
                return std::max(v, 0.0);
            };
            double sum = 0;
            constexpr int steps = 400;
            for (int i = 0; i < steps; ++i)
                sum += transmission(std::max(t, 0.0) + (length - std::max(t, 0.0)) * (i + 0.5) / steps);
            return t >= length ? 0 : sum / steps * (length - std::max(t, 0.0));
        };
        const ImageComparison c = compareExpected(
            image.film,
            [&](int x, int) {
                double sum = 0;
                for (int i = 0; i < 50; ++i) sum += later(((x + (i + 0.5) / 50) / 8 - 1 + 0.75) / 1.5 * length);
                return full * sum / 50;
            },
            Channel::y, 4);
        INFO(opening << " " << closing << ": " << c.text());
        CHECK(c.same());
        CHECK(c.error < kSeen);
    }
}

} // namespace abbe::test
