// Cameras and white balance, from the scene to the pixels.
#include "spectrum/curve.h"
#include "spectrum/named_spectra.h"
#include "support/scene_test.h"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>

namespace abbe::test {
namespace {

TestScene skyScene(const std::string& film, const std::string& light = "radiance 1") {
    return TestScene::parse("scene 1\ncamera { from 0 0 5; look-at 0 0 0 }\nfilm { size 8 8; filter box 0.5; " + film +
                            " }\nlight sky { " + light + " }\n");
}

Xyz meanOf(const TestScene& scene) {
    const TestImage image = render(scene, 2048);
    return {image.film.image(Channel::x).mean, image.film.image(Channel::y).mean, image.film.image(Channel::z).mean};
}

double distance(const Xyz& a, const Xyz& b) {
    return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
}

// The picture's RGB of a film's XYZ, as image_output makes it.
Vec3d rgbOf(const FilmParams& film, const Xyz& xyz) {
    const FilmSettings s = filmSettings(film);
    return (rgbSpace(s.space).fromXyz() * s.whiteBalance).apply<Vec3d>(xyz);
}

} // namespace

TEST_CASE("sensor: a camera's pixels are its own integrals of the light") {
    const TestScene scene = skyScene("sensor sony-a7-iv; white-balance illuminant A");
    REQUIRE(scene.report() == "");
    const auto light = illuminantCurve(*findIlluminant("A"));
    const Xyz expected = Sensor(*findSensitivities("sony-a7-iv"), *light).integrate(ConstantCurve(1));
    CHECK(distance(expected, {1, 1, 1}) > 0.02); // the observer sees something else
    CHECK(distance(meanOf(scene), expected) < 2e-3);
    CHECK(distance(meanOf(skyScene("")), {1, 1, 1}) < 2e-3);
}

TEST_CASE("white balance: the light that is named has R = G = B in every space and with every sensor") {
    for (const char* sensor : {"cie", "nikon-d850"})
        for (const char* space : {"aces2065-1", "acescg", "rec709"}) {
            CAPTURE(sensor);
            CAPTURE(space);
            const TestScene scene = skyScene(std::string("sensor ") + sensor +
                                                 "; white-balance illuminant FL2; output \"x.exr\" space=" + space,
                                             "color illuminant FL2; luminance 72983 nits");
            REQUIRE(scene.report() == "");
            // Exactly, of the exact light; and of the paths, whose wavelengths are random, within their noise.
            const auto light = illuminantCurve(*findIlluminant("FL2"));
            const Vec3d exact = rgbOf(scene.built().film, scene.scene().sensor.integrate(*light));
            CHECK(length(exact - Vec3d(1, 1, 1)) < 1e-5);
        }
}

TEST_CASE("white balance: one look in all spaces, and none without it") {
    const Xyz colour{0.4, 0.3, 0.1};
    const auto inAces = [&](const std::string& film) { // as programs take an image from one space to another
        const TestScene scene = skyScene(film);
        REQUIRE(scene.report() == "");
        const FilmParams& p = scene.built().film;
        const OutputSpace space = filmSettings(p).space;
        const Xyz xyz = rgbSpace(space).toXyz().apply<Xyz>(rgbOf(p, colour));
        return adaptation(whiteXyz(adoptedNeutral(space)), whiteXyz(rgb::ap0.white)).apply<Xyz>(xyz);
    };
    const Xyz aces = inAces("white-balance blackbody 3200 K");
    for (const char* space : {"acescg", "rec709", "xyz"})
        CHECK(distance(inAces(std::string("white-balance blackbody 3200 K; output \"x.exr\" space=") + space), aces) <
              1e-9);
    CHECK(distance(inAces(""), colour) < 1e-9);
    CHECK(distance(inAces("output \"x.exr\" space=rec709"), colour) > 1e-3);
}

TEST_CASE("white balance: what is no white, or no camera, is an error") {
    const auto codes = [](const std::string& film) {
        std::string text;
        const TestScene scene = skyScene(film);
        for (const Diagnostic& d : scene.diagnostics().all()) text += d.code + " ";
        return text;
    };
    CHECK(codes("white-balance blackbody 1500 K") == "");
    CHECK(codes("white-balance illuminant sodium-low-pressure") == "E0454 ");
    CHECK(codes("sensor nikon-d850; white-balance illuminant sodium-low-pressure") == "E0454 ");
    CHECK(codes("sensor nikon-d85") != "");
    CHECK(codes("output \"x.exr\" container=aces space=acescg") == "E0453 ");
}

} // namespace abbe::test
