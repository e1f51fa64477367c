// Light in media: transmittance and scattering against closed forms, and scenes in which nothing may be lost.
#include "support/scene_test.h"
#include "support/scene_test_compare.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

constexpr const char* kMediaHeader = "scene 1\nfilm { size 16 16; filter box 0.5 }\nlight sky { radiance 1 }\n";
constexpr const char* kOutside = "camera { from 0 0 4; look-at 0 0 0; fov 34 deg }\n";

std::string ball(const std::string& optics) {
    return fmt::format("shape sphere {{ radius 1; material boundary; interior homogeneous {{ {} }} }}\n", optics);
}

void checkFurnace(const std::string& text, double resolution, std::uint32_t samples) {
    INFO(text);
    const TestImage image = render(TestScene::parse(text), samples);
    checkSame(compareExpected(image.film, [](int, int) { return 1.0; }), resolution);
    CHECK(image.statistics.dropped == std::array<std::uint64_t, 3>{});
    CHECK(image.statistics.cappedPaths == 0);
}

} // namespace

TEST_CASE("a white ball of fog in a white surrounding cannot be seen, however dense and however it scatters") {
    for (const double g : {-0.9, 0.0, 0.9})
        for (const double depth : {1e-6, 1.0, 30.0})
            checkFurnace(
                std::string(kMediaHeader) + kOutside +
                    ball(fmt::format("extinction {} per-m; albedo 1; phase henyey-greenstein {}", depth / 2, g)),
                depth > 10 ? 0.01 : 0.002, depth > 10 ? 256 : 512);
    if (nightly())
        checkFurnace(std::string(kMediaHeader) + kOutside + ball("extinction 500 per-m; albedo 1"), 0.02, 512);
}

TEST_CASE("nor can one far from the camera, where a collision's place is rounded to a good part of a mean free path") {
    checkFurnace(std::string(kMediaHeader) + "camera { from 0 0 2000; look-at 0 0 0; fov 0.03 deg }\n" +
                     ball("extinction 100 per-m; albedo 1"),
                 0.005, 384);
}

TEST_CASE("nor can one whose extinction varies sixteenfold over the wavelengths") {
    checkFurnace(std::string(kMediaHeader) + kOutside + ball("extinction table 400 0.25 700 4 per-m; albedo 1"), 0.004,
                 1024);
}

TEST_CASE("overlapping balls, a glass one in fog, and a camera in the midst") {
    const std::string fog = ball("extinction 0.7 per-m; albedo 1; phase henyey-greenstein 0.5");
    const std::string second = "shape sphere { center 0.5 0 0; radius 0.8; material boundary; interior homogeneous { "
                               "extinction 2 per-m; albedo 1 } }\n";
    checkFurnace(std::string(kMediaHeader) + kOutside + fog + second, 0.004, 512);
    checkFurnace(std::string(kMediaHeader) + kOutside + fog + "shape sphere { radius 0.5; material dielectric }\n",
                 0.006, 512);
    checkFurnace(std::string(kMediaHeader) + "camera { from 0.1 0.2 0.3; look-at 0 0 -1; fov 60 deg }\n" + fog + second,
                 0.004, 512);
    checkFurnace(std::string(kMediaHeader) + kOutside +
                     "shape sphere { radius 1; material dielectric; interior homogeneous { extinction 3 per-m } }\n",
                 0.008, 512);
}

TEST_CASE("what comes through an absorbing ball: Beer-Lambert along every chord") {
    // Extinction 0.8 per m, albedo 0: radiance e^(-0.8 chord) of the sky's.
    const auto scene = TestScene::parse(std::string(kMediaHeader) + kOutside + ball("extinction 0.8 per-m; albedo 0"));
    const TestImage image = render(scene, 512);
    const double half = std::tan(17 * kPiD / 180);
    checkSame(compareExpected(image.film,
                              [&](int px, int py) {
                                  double sum = 0; // over the pixel
                                  constexpr int n = 32;
                                  for (int i = 0; i < n * n; ++i) {
                                      const double x = ((px + (i % n + 0.5) / n) / 8 - 1) * half;
                                      const double y = ((py + (i / n + 0.5) / n) / 8 - 1) * half;
                                      const double sine2 = (x * x + y * y) / (1 + x * x + y * y);
                                      const double inside = 1 - 16 * sine2; // of the half chord, squared
                                      sum += inside > 0 ? std::exp(-0.8 * 2 * std::sqrt(inside)) : 1;
                                  }
                                  return sum / (n * n);
                              }),
              0.004);
}

TEST_CASE("the two strategies and both together agree in fog with a light") {
    const std::string text =
        "scene 1\nfilm { size 16 16; filter box 0.5 }\n" + std::string(kOutside) +
        "shape sphere { center 0.3 1.6 0.2; radius 0.4; emission 5; material diffuse { reflectance 0 } }\n"
        "shape plane { center 0 -1.2 0; material diffuse }\n" +
        ball("extinction table 400 1 700 3 per-m; albedo 0.8; phase henyey-greenstein 0.4") +
        "volume atmosphere { extinction 0.05 per-m; scale-height 1 m; ground -1.2 m; phase rayleigh }\n";
    const TestScene scene = TestScene::parse(text);
    const std::vector<TestImage> images = renderByEachStrategy(scene, 2048);
    checkSame(compareImages(images[0].film, images[1].film), 0.02);
    checkSame(compareImages(images[0].film, images[2].film), 0.06);
}

} // namespace abbe::test
