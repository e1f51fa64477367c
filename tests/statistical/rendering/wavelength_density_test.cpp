// Paths whose wavelengths follow the lights, against the smooth density: the same image, with less noise.
#include "support/scene_test_compare.h"
#include "support/scene_test_paths.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

TestScene litRoom(const std::string& color) {
    return TestScene::parse(
        "scene 1\nfilm { size 16 16; filter box 0.5 }\n"
        "camera { from 0 0.4 3; look-at 0 0 0; fov 40 deg }\n"
        "light quad { points -1 2 -1  1 2 -1  1 2 1  -1 2 1; luminance 800 nits; color " +
        color +
        " }\n"
        "shape plane { transform { translate 0 -0.5 0 }; material diffuse { reflectance rgb 0.8 0.3 0.1 } }\n"
        "shape sphere { radius 0.5; material diffuse { reflectance rgb 0.2 0.5 0.9 } }\n");
}

double meanVariance(const RecordingFilm& film, Channel channel) {
    double sum = 0;
    const PixelBounds b = film.bounds();
    for (int y = b.y0; y < b.y1; ++y)
        for (int x = b.x0; x < b.x1; ++x) sum += film.pixel(x, y, channel).variance;
    return sum;
}

} // namespace

TEST_CASE("an image is the same with either density of wavelengths; lines have less noise") {
    struct Case {
        std::string color;
        bool follows;
        double gain; // least ratio of the variances of Y
    };
    for (const auto& [color, follows, gain] : {Case{"illuminant FL11", true, 1.5},
                                               {"illuminant sodium-low-pressure", true, 10},
                                               {"line 632.8", true, 50},
                                               {"illuminant A", false, 0.5}}) {
        CAPTURE(color);
        const TestScene scene = litRoom(color);
        CHECK(scene.scene().wavelengths.followsLights() == follows);
        const std::uint32_t samples = nightly() ? 512 : 64;
        const RecordingFilm smooth = renderPaths<0>(scene, {.samples = samples, .seed = 5});
        const RecordingFilm best = renderPaths<0>(scene, {.samples = samples, .seed = 6, .wavelengths = [&](double u) {
                                                              return scene.scene().wavelengths.sample(u);
                                                          }});
        for (const Channel channel : {Channel::x, Channel::y, Channel::z})
            checkSame(compareImages(best, smooth, channel), 0.05);
        const double ratio = meanVariance(smooth, Channel::y) / meanVariance(best, Channel::y);
        MESSAGE(fmt::format("{}: variance of X, Y, Z {:.2f}, {:.2f}, {:.2f} times that of the table", color,
                            meanVariance(smooth, Channel::x) / meanVariance(best, Channel::x), ratio,
                            meanVariance(smooth, Channel::z) / meanVariance(best, Channel::z)));
        CHECK(ratio > gain);
    }
}

} // namespace abbe::test
