#include "pictures/exposure_meter.h"
#include "rendering/path_tracer.h"
#include "support/scene_test.h"

#include <cmath>
#include <doctest/doctest.h>
#include <vector>

using namespace abbe;

namespace {

constexpr double kNitsOfUnit = 72983.27; // of Y = 1

std::optional<double> metered(const std::string& text, double sensitivity = 1) {
    const auto scene = test::TestScene::parse("scene 1\n" + text + "\n");
    REQUIRE(scene.report() == "");
    return meterExposure(scene.scene(), *makePathTracer(scene.scene().effects), 0, sensitivity);
}

std::optional<double> stopsOf(std::vector<float> luminances) { return stopsForMiddleGrey(luminances); }

} // namespace

TEST_CASE("the geometric mean of a picture becomes middle grey") {
    CHECK(stopsOf({0.18f}) == 0);
    CHECK(stopsOf({8 * 0.18f, 8 * 0.18f}) == -3);
    CHECK(stopsOf({0.18f / 4, 0.18f / 16}) == 3);
    CHECK(stopsOf({0.2f}) == doctest::Approx(-0.2)); // −0.15, in tenths
    CHECK_FALSE(stopsOf({}));
    CHECK_FALSE(stopsOf({0, 0, -1, std::nanf("")}));
}

TEST_CASE("night around a picture is not metered, and neither are pixels without light") {
    std::vector<float> picture(100, 0.18f);
    picture.resize(150, 1e-5f);
    CHECK(stopsForMiddleGrey(picture) == 0);
    picture.resize(1000, 0.f);
    CHECK(stopsForMiddleGrey(picture) == 0);
    CHECK(stopsOf({0.18f, 0.18f, 0.18f * 0.002f}) == doctest::Approx(3.0)); // a thousandth is the bound: log2(500)/3
}

TEST_CASE("a scene of even radiance is metered exactly, whatever its size and its seed") {
    const double expected = std::round(10 * std::log2(0.18 * kNitsOfUnit / 1000)) / 10; // 3.7
    for (const char* size : {"64 48", "1 1", "5 300", "4000 3000"})
        for (const char* seed : {"0", "7"})
            CHECK(metered("film { size " + std::string(size) + " }\nrender { seed " + seed +
                          " }\ncamera { from 0 0 5; look-at 0 0 0; exposure auto }\nlight sky { luminance 1000 nits }"
                          "\nshape sphere { radius 0.5; material diffuse { reflectance 1 } }") ==
                  doctest::Approx(expected));
}

TEST_CASE("stops count from what the sensor makes of the light") {
    const std::string scene =
        "film { size 32 32 }\ncamera { from 0 0 5; look-at 0 0 0 }\nlight sky { luminance 1000 nits }";
    CHECK(*metered(scene, 4) == doctest::Approx(*metered(scene) - 2));
}

TEST_CASE("a look that finds no light says so") {
    CHECK_FALSE(metered("film { size 16 16 }\ncamera { from 0 0 5; look-at 0 0 9 }\n"
                        "light quad { size 1 1 m; luminance 9 nits }"));
}
