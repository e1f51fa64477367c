// Closed rooms and white surroundings: scenes in which every path must bring back the same light, whatever it meets.
#include "support/scene_test.h"
#include "support/scene_test_compare.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

constexpr const char* kFurnaceHeader = "scene 1\nfilm { size 16 16; filter box 0.5 }\n";

// A room whose six walls emit 1 and reflect ρ: radiance 1/(1 - ρ) everywhere, by Russian roulette alone.
TestScene room(double rho, const std::string& inside) {
    return TestScene::parse(
        kFurnaceHeader +
        fmt::format(
            "camera {{ from 0.3 0.1 0.9; look-at -0.2 -0.1 -1; fov 80 deg }}\n"
            "shape mesh {{ material diffuse {{ reflectance {} }}; emission 1\n"
            "  points {{ - -1 -1 -1; - 1 -1 -1; - 1 1 -1; - -1 1 -1; - -1 -1 1; - 1 -1 1; - 1 1 1; - -1 1 1 }}\n"
            "  faces {{ - 0 1 2 3; - 7 6 5 4; - 4 5 1 0; - 5 6 2 1; - 6 7 3 2; - 7 4 0 3 }} }}\n",
            rho) +
        inside);
}

void checkRoom(const TestScene& scene, double expected, std::uint32_t samples, double resolution) {
    const TestImage image = render(scene, samples);
    checkSame(compareExpected(image.film, [&](int, int) { return expected; }), resolution);
    CHECK(image.statistics.cappedPaths == 0);
    CHECK(image.statistics.dropped == std::array<std::uint64_t, 3>{});
}

constexpr const char* kLosslessSphere = "shape sphere {{ center 0 -0.2 -0.2; radius 0.4; material {} }}\n";

} // namespace

TEST_CASE("a closed room of emitting walls: 1/(1 - ρ), without a limit of depth") {
    checkRoom(room(0.5, ""), 2, nightly() ? 2048 : 1024, nightly() ? 0.0005 : 0.0007);
    checkRoom(room(0.9, ""), 10, nightly() ? 1024 : 512, nightly() ? 0.001 : 0.0014);
    checkRoom(room(0.99, ""), 100, 128, 0.004);
    if (nightly()) checkRoom(room(0.999, ""), 1000, 384, 0.004);
}

TEST_CASE("a lossless object in a closed room changes nothing") {
    // Radiance inside glass is n² times that outside, which the eye, being outside, never sees.
    for (const char* material :
         {"diffuse { reflectance 1 }", "dielectric { ior 1.5 }", "dielectric { ior glass SF11 }",
          "dielectric { ior 1.5; roughness 0.4 }", "dielectric { ior glass SF11; roughness 0.4 }"}) {
        INFO(std::string(material));
        // Energy compensation of rough glass is by table; what it leaves is below 0.3 % (statistical tests of
        // materials).
        const bool rough = std::string(material).find("roughness") != std::string::npos;
        const TestImage image = render(room(0.5, fmt::format(fmt::runtime(kLosslessSphere), material)), 512);
        const Estimate mean = image.film.image();
        if (rough)
            CHECK(mean.mean == doctest::Approx(2).epsilon(0.003));
        else
            checkSame(compareExpected(image.film, [](int, int) { return 2.0; }), 0.004);
        CHECK(image.statistics.dropped == std::array<std::uint64_t, 3>{});
    }
}

TEST_CASE("a dispersive glass sphere in white surroundings cannot be seen, in brightness or in colour") {
    const auto scene =
        TestScene::parse(std::string(kFurnaceHeader) + "camera { from 0 0 4; look-at 0 0 0; fov 25 deg }\n"
                                                       "light sky { radiance 1 }\n"
                                                       "shape sphere { material dielectric { ior glass SF11 } }\n");
    const TestImage image = render(scene, nightly() ? 32768 : 4096);
    CHECK(image.statistics.kernel == "absorption+dispersion");
    checkSame(compareExpected(image.film, [](int, int) { return 1.0; }), 0.002);
    // Equal energy is white: X = Y = Z up to the tables of the observer (x = y = 1/3 within 1e-4).
    const auto plain = TestScene::parse(std::string(kFurnaceHeader) +
                                        "camera { from 0 0 4; look-at 0 0 0; fov 25 deg }\nlight sky { radiance 1 }\n");
    const TestImage white = render(plain, 1024);
    const auto chromaticity = [](const RecordingFilm& film) {
        const double x = film.image(Channel::x).mean, y = film.image(Channel::y).mean, z = film.image(Channel::z).mean;
        return Vec2d{x / (x + y + z), y / (x + y + z)};
    };
    const Vec2d seen = chromaticity(image.film), reference = chromaticity(white.film);
    CHECK(std::abs(seen.x - reference.x) < 5e-4);
    CHECK(std::abs(seen.y - reference.y) < 5e-4);
    CHECK(std::abs(reference.x - 1.0 / 3) < 1e-4);
    CHECK(std::abs(reference.y - 1.0 / 3) < 1e-4);
    for (const Channel channel : {Channel::x, Channel::z})
        checkSame(compareExpected(
                      image.film, [&, level = white.film.image(channel).mean](int, int) { return level; }, channel),
                  0.004);
}

} // namespace abbe::test
