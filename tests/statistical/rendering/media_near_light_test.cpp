// Lights in thin fog: distances drawn towards the light beside those of tracking.
#include "support/scene_test.h"
#include "support/scene_test_compare.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

constexpr const char* kView = "scene 1\nfilm { size 16 16; filter box 0.5 }\n"
                              "camera { from 0 0 4; look-at 0 0 0; fov 34 deg }\n";

// Single scattering of a point light of 1 W/sr/nm along the ray through a pixel's place, in fog of extinction s that
// does not absorb: the second order is s times as much again and is left to the resolution.
double single(double x, double y, double s) {
    const Vec3d d = normalize(Vec3d{x, y, -1}), light{0.4, 1.6, 0};
    constexpr int n = 4000;
    const double closest = dot(light - Vec3d{0, 0, 4}, d);
    double sum = 0;
    // By the angle at the light, in which the integrand is smooth.
    const Vec3d foot = Vec3d{0, 0, 4} + d * closest;
    const double h = length(light - foot), from = std::atan(-closest / h), to = kPiD / 2;
    for (int i = 0; i < n; ++i) {
        const double a = from + (to - from) * (i + 0.5) / n, t = closest + h * std::tan(a);
        const double r = h / std::cos(a);
        sum += s * std::exp(-s * (t + r)) / (4 * kPiD) / h * (to - from) / n;
    }
    return sum;
}

} // namespace

TEST_CASE("a light in thin fog: single scattering along every ray, and little noise") {
    constexpr double s = 2e-4;
    const auto scene = TestScene::parse(std::string(kView) + "light point { position 0.4 1.6 0; intensity 100 cd }\n" +
                                        fmt::format("volume air atmosphere {{ extinction {} per-m; albedo 1 }}\n", s));
    RenderSettings settings = scene.settings();
    settings.samples = 512;
    settings.maxDepth = 1;
    const TestImage image = render(scene, settings);
    // Relative to the middle of the image: the light's spectrum drops out.
    const double half = std::tan(17 * kPiD / 180);
    const auto expected = [&](int px, int py) {
        double sum = 0;
        for (int i = 0; i < 16; ++i)
            sum += single(((px + (i % 4 + 0.5) / 4) / 8 - 1) * half, (1 - (py + (i / 4 + 0.5) / 4) / 8) * half, s) / 16;
        return sum;
    };
    const PixelBounds all = image.film.bounds();
    double total = 0;
    for (int y = all.y0; y < all.y1; ++y)
        for (int x = all.x0; x < all.x1; ++x) total += expected(x, y);
    const double scale = image.film.tile(all, Channel::y).mean / (total / static_cast<double>(all.area()));
    checkSame(compareExpected(image.film, [&](int x, int y) { return scale * expected(x, y); }), 0.003);
}

TEST_CASE("spots, balls, mirrors and moving lights in fog: the same with and without scattering towards them") {
    const char* const lights[] = {
        "light sphere { center 0.3 1.9 0; radius 0.5; power 100 W }\n",
        "light sphere { center 0.3 1.9 0; radius 0.5; power 100 W }\n"
        "shape sphere { center -0.4 -0.3 0; radius 0.4; material conductor { index metal Ag; roughness 0 } }\n",
        "light sphere { center 0.3 1.9 0; radius 0.5; power 100 W }\n"
        "shape sphere { radius 0.9; material boundary; interior homogeneous { extinction 0.8 per-m; albedo 0.9; "
        "phase henyey-greenstein 0.6 } }\n"};
    const char* const extinctions[] = {"0.05 per-m", "1 per-m", "table 400 0.5 700 2 per-m"};
    // By day each light and each fog once.
    for (std::size_t l = 0; l < std::size(lights); ++l)
        for (std::size_t e = 0; e < std::size(extinctions); ++e) {
            if (!nightly() && l != e) continue;
            const char *const emitter = lights[l], *const extinction = extinctions[e];
            INFO(emitter, extinction);
            TestScene scene = TestScene::parse(
                std::string(kView) + emitter +
                fmt::format("volume air atmosphere {{ extinction {}; albedo 0.8; scale-height 3 m }}\n", extinction));
            RenderSettings settings = scene.settings();
            settings.samples = 768;
            settings.maxDepth = 4;
            const TestImage both = render(scene, settings);
            settings.technique.strategy = Technique::Strategy::bsdfOnly; // finds the light by chance alone
            settings.samples = 4096;
            ++settings.seed;
            checkSame(compareImages(both.film, render(scene, settings).film), 0.05);
        }
}

} // namespace abbe::test
