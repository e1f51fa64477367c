// Partly open surfaces: the share of light that their opacity leaves goes straight on, to the eye and from lights.
#include "support/ray_estimate.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

// Sheets of an opacity over each other, over the ground.
std::string sheets(double opacity, const char* light) {
    return fmt::format(R"(scene 1
camera {{ from 0 0.5 0; look-at 0 0.5 -1 }}
{}
material veil diffuse {{ reflectance 0; opacity {} }}
shape quad {{ size 200 200; material veil; transform {{ rotate x -90 deg; translate 0 1 0 }} }}
shape quad {{ size 200 200; material veil; transform {{ rotate x -90 deg; translate 0 1.25 0 }} }}
shape quad {{ size 200 200; material diffuse {{ reflectance 0.5 }}; transform {{ rotate x -90 deg }} }}
)",
                       light, opacity);
}

} // namespace

TEST_CASE("the eye sees the share of the sky that two open sheets leave") {
    for (const double opacity : {0.0, 0.3, 0.9, 1.0}) {
        CAPTURE(opacity);
        const TestScene scene = TestScene::parse(sheets(opacity, "light sky { radiance 1 }"));
        REQUIRE(scene.report() == "");
        const RayEstimate e = seenAlong(scene, {0, 0.5f, 0}, {0.1f, 1, 0.2f});
        const double open = (1 - opacity) * (1 - opacity);
        CHECK(std::abs(e.mean - open) < 4 * e.error + 1e-6);
        CHECK((e.mean > 0) == (opacity < 1));
    }
}

TEST_CASE("lights and the sky shine through open sheets, found on the light or by chance") {
    for (const char* light : {"light sky { radiance 1 }", "light point { position 0 2 0; intensity 100 cd }",
                              "light sun { toward 0 -1 0; angular-diameter 20 deg; irradiance 3 W-per-m2 }"}) {
        CAPTURE(light);
        const RayEstimate clear = seenAlong(TestScene::parse(sheets(0, light)), {0, 0.5f, 0}, {0.05f, -1, 0.02f});
        const RayEstimate veiled = seenAlong(TestScene::parse(sheets(0.4, light)), {0, 0.5f, 0}, {0.05f, -1, 0.02f});
        CHECK(clear.mean > 0);
        CHECK(std::abs(veiled.mean - 0.36 * clear.mean) < 4 * std::hypot(veiled.error, 0.36 * clear.error) + 1e-6);
    }
}

TEST_CASE("only open surfaces ask for the walk through surfaces") {
    CHECK(TestScene::parse(sheets(0.4, "light sky { radiance 1 }")).scene().effects.has(Effect::interfaces));
    CHECK(!TestScene::parse(sheets(1, "light sky { radiance 1 }")).scene().effects.has(Effect::interfaces));
}

} // namespace abbe::test
