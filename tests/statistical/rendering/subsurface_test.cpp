// Light under the surface: the colour that was asked for, nothing lost or leaked, and wavelengths that go far and near.
#include "support/scene_test_compare.h"
#include "support/scene_test_paths.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

const std::string kSubsurfaceFilm = "scene 1\nfilm { size 8 8; filter box 0.5 }\n";

// The reflectance of a half space in even light.
Estimate halfSpace(const std::string& material, std::uint32_t samples) {
    const TestScene scene =
        TestScene::parse(kSubsurfaceFilm +
                         "camera { from 0 1 2; look-at 0 0 0; fov 10 deg }\nlight sky { radiance 1 }\n"
                         "shape plane { material subsurface { " +
                         material + " } }\n");
    const TestImage image = render(scene, samples);
    CHECK(image.statistics.dropped == std::array<std::uint64_t, 3>{});
    CHECK(image.statistics.cappedPaths == 0);
    return image.film.image();
}

void checkSubsurfaceFurnace(const std::string& material, std::uint32_t samples, double tolerance) {
    INFO(material);
    const TestScene scene = TestScene::parse(
        kSubsurfaceFilm + "camera { from 0 0.6 4; look-at 0 0 0; fov 18 deg }\nlight sky { radiance 1 }\n" +
        fmt::format("shape sphere {{ material subsurface {{ {} }} }}\n", material));
    const TestImage image = render(scene, samples);
    // A path that has leaked never comes back: the medium that it took along has no end.
    CHECK(image.statistics.cappedPaths == 0);
    CHECK(image.statistics.dropped == std::array<std::uint64_t, 3>{});
    const Estimate mean = image.film.image();
    MESSAGE(mean.mean, " ± ", std::sqrt(mean.variance));
    CHECK(std::abs(mean.mean - 1) < tolerance + 4 * std::sqrt(mean.variance));
    CHECK(std::sqrt(mean.variance) < 0.004);
}

} // namespace

TEST_CASE("subsurface: a deep layer sends back its reflectance, whatever its anisotropy") {
    const std::uint32_t samples = nightly() ? 8192 : 512;
    for (const double color : {0.1, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95})
        for (const double g : {0.0, 0.7, -0.4}) {
            if (g != 0 && !nightly() && color != 0.5 && color != 0.9) continue;
            const Estimate seen = halfSpace(
                fmt::format("reflectance {}; anisotropy {}; mean-free-path 1 mm; ior 1; boundary diffuse", color, g),
                samples);
            MESSAGE("reflectance ", color, ", anisotropy ", g, ": ", seen.mean, " ± ", std::sqrt(seen.variance));
            CHECK(std::sqrt(seen.variance) < 0.009 * color);
            // Similarity knows least of light that is scattered back once or twice.
            CHECK(std::abs(seen.mean / color - 1) < (g < 0 && color < 0.2 ? 0.06 : 0.02));
        }
}

TEST_CASE("subsurface: what is white loses nothing, and nothing leaks out of closed shapes") {
    const std::uint32_t samples = nightly() ? 4096 : 256;
    for (const std::string path : {"mean-free-path 10 cm; ", "mean-free-path table 400 5  700 30 cm; "}) {
        const std::string white = "reflectance 1; ior 1.5; " + path;
        checkSubsurfaceFurnace(white + "boundary diffuse; roughness 0.4", samples, 0.002);
        checkSubsurfaceFurnace(white + "boundary diffuse; roughness 0", samples, 0.002);
        checkSubsurfaceFurnace(white + "boundary dielectric; roughness 0", samples, 0.002);
        // Rough dielectrics keep their energy to 0.3 % at each crossing (tests of materials).
        checkSubsurfaceFurnace(white + "boundary dielectric; roughness 0.4", samples, 0.006);
    }
}

// Positions at 4.6 m are told apart to half a micrometre.
TEST_CASE("subsurface: a mean free path that is next to nothing gives the picture of a longer one, and says so") {
    const auto seen = [](const std::string& material) {
        const TestScene scene = TestScene::parse(
            kSubsurfaceFilm + "camera { from 0 0.6 4; look-at 0 0 0; fov 18 deg }\nlight sky { radiance 1 }\n" +
            fmt::format("shape sphere {{ material subsurface {{ {} }} }}\n", material));
        CHECK((scene.report().find("W0697") != std::string::npos) == (material.find("1e-9") != std::string::npos));
        const TestImage image = render(scene, nightly() ? 4096 : 512);
        // A path of white light has more than a million collisions in one case of a thousand.
        CHECK(static_cast<double>(image.statistics.cappedPaths) < 3e-3 * static_cast<double>(image.statistics.paths));
        return image.film.image();
    };
    for (const std::string boundary : {"diffuse", "dielectric"}) {
        const std::string path = "; ior 1.5; roughness 0; boundary " + boundary + "; mean-free-path ";
        const Estimate white = seen("reflectance 1" + path + "1e-9 m");
        MESSAGE(boundary, ", white: ", white.mean, " ± ", std::sqrt(white.variance));
        CHECK(std::sqrt(white.variance) < 0.02);
        CHECK(std::abs(white.mean - 1) < 0.003 + 4 * std::sqrt(white.variance));
        const Estimate none = seen("reflectance 0.5" + path + "1e-9 m"), some = seen("reflectance 0.5" + path + "1 mm");
        MESSAGE(boundary, ", grey: ", none.mean, ", of 1 mm ", some.mean);
        CHECK(std::abs(none.mean / some.mean - 1) < 0.025 + 4 * std::sqrt(none.variance + some.variance) / some.mean);
    }
}

TEST_CASE("subsurface: eight wavelengths to a path agree with one, where red goes far and blue does not") {
    for (const std::string boundary : {"diffuse", "dielectric"}) {
        if (boundary == "diffuse" && !nightly()) continue;
        INFO(boundary);
        const TestScene scene = TestScene::parse(
            "scene 1\nfilm { size 16 16; filter box 0.5 }\ncamera { from 0 0 4; look-at 0 0 0; fov 36 deg }\n"
            "light sky { radiance 0.2 }\nlight quad { points { - 1 2 1; - 2 2 1; - 2 2 0; - 1 2 0 }; two-sided on; "
            "radiance 8 }\n"
            "shape sphere { radius 1; material subsurface { reflectance table 400 0.45  600 0.7  700 0.85; "
            "mean-free-path table 400 5  550 12  700 60 cm; anisotropy 0.3; ior 1.4; boundary " +
            boundary + " } }\n");
        const TestImage hero = render(scene, nightly() ? 8192 : 512);
        constexpr EffectBits kGrey = (Effects(Effect::absorption) | Effect::media | Effect::interfaces).bits();
        const RecordingFilm single = renderPaths<kGrey>(
            scene, {.samples = nightly() ? 16384u : 2048u, .seed = 77, .wavelengths = oneWavelength});
        for (const Channel channel : {Channel::x, Channel::y, Channel::z})
            checkSame(compareImages(hero.film, single, channel), nightly() ? 0.01 : 0.015);
    }
}

} // namespace abbe::test
