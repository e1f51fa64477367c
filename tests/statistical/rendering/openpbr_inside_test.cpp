// Solids with an OpenPBR surface: light under it, and glass that scatters.
#include "support/scene_test_compare.h"
#include "support/scene_test_paths.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

const std::string kBall = "scene 1\nfilm { size 16 16; filter box 0.5 }\n"
                          "camera { from 0 0.6 4; look-at 0 0 0; fov 18 deg }\nlight sky { radiance 1 }\n";
// Lit from the side, so that it shows how far light spreads.
const std::string kLitInside =
    "scene 1\nfilm { size 16 16; filter box 0.5 }\ncamera { from 0 0 4; look-at 0 0 0; fov 36 deg }\n"
    "light sky { radiance 0.2 }\nlight quad { points { - 1 2 1; - 2 2 1; - 2 2 0; - 1 2 0 }; two-sided on; "
    "radiance 8 }\n";

std::string openPbr(const std::string& properties) {
    return "shape sphere { radius 1; material openpbr { " + properties + " } }\n";
}

void checkHealth(const TestImage& image) {
    // A path that has leaked never comes back: the medium that it took along has no end.
    CHECK(image.statistics.cappedPaths == 0);
    CHECK(image.statistics.dropped == std::array<std::uint64_t, 3>{});
}

void checkInsideFurnace(const std::string& scene, std::uint32_t samples, double tolerance) {
    INFO(scene);
    const TestImage image = render(TestScene::parse(scene), samples);
    checkHealth(image);
    const Estimate mean = image.film.image();
    MESSAGE(mean.mean, " ± ", std::sqrt(mean.variance));
    CHECK(std::abs(mean.mean - 1) < tolerance + 4 * std::sqrt(mean.variance));
    CHECK(std::sqrt(mean.variance) < 0.002);
}

RecordingFilm rendered(const std::string& scene, std::uint32_t samples) {
    INFO(scene);
    TestImage image = render(TestScene::parse(scene), samples);
    checkHealth(image);
    return std::move(image.film);
}

} // namespace

TEST_CASE("openpbr solids: what is white loses nothing, under every layer") {
    const std::uint32_t samples = nightly() ? 4096 : 256;
    const std::string some = "base-color 1; subsurface-color 1; subsurface-radius 40 cm; "
                             "subsurface-radius-scale table 400 0.2  700 1; ",
                      white = some + "subsurface-weight 1; ";
    checkInsideFurnace(kBall + openPbr(white), samples, 0.004);
    checkInsideFurnace(kBall + openPbr(some + "subsurface-weight 0.5"), samples, 0.004);
    checkInsideFurnace(kBall +
                           openPbr(white + "subsurface-scatter-anisotropy 0.8; specular-roughness 0; coat-weight 1"),
                       samples, 0.004);
    checkInsideFurnace(
        kBall + openPbr(white + "coat-weight 0.5; coat-roughness 0.3; fuzz-weight 0.5; base-diffuse-roughness 1"),
        samples, 0.004);
    // Every crossing of rough glass keeps its energy to 0.3 %.
    const std::string milky = "transmission-weight 1; transmission-color 0.5; transmission-depth 1 m; "
                              "transmission-scatter 1; transmission-scatter-anisotropy 0.5; ";
    checkInsideFurnace(kBall + openPbr(milky + "specular-roughness 0"), samples, 0.002);
    checkInsideFurnace(kBall + openPbr(milky + "specular-roughness 0.4"), samples, 0.006);
}

TEST_CASE("openpbr solids: subsurface light is that of the material `subsurface`") {
    const std::uint32_t samples = nightly() ? 8192 : 512;
    const RecordingFilm mine = rendered(
        kLitInside +
            openPbr("specular-ior 1.4; specular-roughness 0.5; subsurface-weight 1; subsurface-radius 60 cm; "
                    "subsurface-radius-scale table 400 0.1  550 0.2  700 1; subsurface-scatter-anisotropy 0.3; "
                    "subsurface-color table 400 0.45  600 0.7  700 0.85"),
        samples);
    const RecordingFilm other = rendered(
        kLitInside +
            "shape sphere { radius 1; material subsurface { ior 1.4; roughness 0.5; boundary diffuse; anisotropy 0.3; "
            "mean-free-path table 400 6  550 12  700 60 cm; "
            "reflectance table 400 0.45  600 0.7  700 0.85 } }\n",
        samples);
    for (const Channel channel : {Channel::x, Channel::y, Channel::z})
        checkSame(compareImages(mine, other, channel), 0.01);
}

TEST_CASE("openpbr solids: scattering glass is the material `dielectric` around the same medium") {
    const std::uint32_t samples = nightly() ? 8192 : 512;
    // At 400 nm σt = -ln 0.2 / 0.5 m = 3.22/m and σs = 0.8/0.5 m; at 700 nm σs = 1.2/m is more than σt, and all of σt
    // is raised by what is missing.
    const RecordingFilm mine = rendered(
        kLitInside + openPbr("specular-ior 1.4; specular-roughness 0.3; transmission-weight 1; transmission-depth "
                             "50 cm; transmission-scatter table 400 0.8  700 0.6; transmission-color table 400 0.2 "
                             " 700 0.8; transmission-scatter-anisotropy 0.4"),
        samples);
    const double raised = 0.6 / 0.5 + std::log(0.8) / 0.5;
    std::string extinction, albedo;
    for (int i = 0; i <= 30; ++i) {
        const double nm = 400 + 10 * i, at = i / 30.0, color = 0.2 + 0.6 * at, scatter = 0.8 - 0.2 * at;
        const double sigma = -std::log(color) / 0.5 + raised;
        extinction += fmt::format("- {} {:.9g}; ", nm, sigma);
        albedo += fmt::format("- {} {:.9g}; ", nm, scatter / 0.5 / sigma);
    }
    const RecordingFilm other =
        rendered(kLitInside +
                     "shape sphere { radius 1; material dielectric { ior 1.4; roughness 0.3 }; interior homogeneous { "
                     "extinction "
                     "table { " +
                     extinction + "}; albedo table { " + albedo + "}; phase henyey-greenstein { g 0.4 } } }\n",
                 samples);
    for (const Channel channel : {Channel::x, Channel::y, Channel::z})
        checkSame(compareImages(mine, other, channel), 0.01);
}

// A ball that scatters nothing, in an even sky: light that enters evenly follows chords of 2 cos θ radii, and of it
// ∫ 2 cos θ exp(-a cos θ) d cos θ = 2 (1 - (1 + a) exp(-a))/a² is left, a diameters in mean free paths, wherever one
// looks.
TEST_CASE("subsurface: the mean free path is what it is said to be") {
    for (const std::string material :
         {"openpbr { subsurface-weight 1; subsurface-color 0; subsurface-radius 2 m; subsurface-radius-scale 0.5; "
          "specular-weight 0 }",
          "subsurface { reflectance 0; mean-free-path 1 m; boundary diffuse; ior 1 }"}) {
        const TestImage image =
            render(TestScene::parse(kBall + "shape sphere { radius 1; material " + material + " }\n"), 2048);
        checkHealth(image);
        const double a = 2, expected = 2 * (1 - (1 + a) * std::exp(-a)) / square(a);
        checkSame(compareExpected(image.film, [&](int, int) { return expected; }), 0.0025);
    }
}

TEST_CASE("openpbr solids: without subsurface light they are matte, and between they are the mixture of both") {
    const std::uint32_t samples = nightly() ? 4096 : 256;
    const std::string look = "base-color 0.2; subsurface-color 0.8; subsurface-radius 30 cm; coat-weight 0.5; "
                             "coat-darkening 0; coat-color 0.6; subsurface-weight ";
    const auto image = [&](const std::string& weight) {
        return rendered(kLitInside + openPbr(look + weight), samples);
    };
    const RecordingFilm none = image("0"), all = image("1"), some = image("0.3"), little = image("1e-5");
    checkSame(compareImages(none, rendered(kLitInside + openPbr("base-color 0.2; coat-weight 0.5; coat-darkening 0; "
                                                                "coat-color 0.6"),
                                           samples)));
    checkSame(compareImages(little, none), 0.01);
    checkSame(compareTiles(
                  some.bounds(), 8, [&](PixelBounds t) { return some.tile(t, Channel::y); },
                  [&](PixelBounds t) {
                      const Estimate a = none.tile(t, Channel::y), b = all.tile(t, Channel::y);
                      return Estimate{0.7 * a.mean + 0.3 * b.mean, 0.49 * a.variance + 0.09 * b.variance, a.degrees};
                  }),
              0.01);
}

} // namespace abbe::test
