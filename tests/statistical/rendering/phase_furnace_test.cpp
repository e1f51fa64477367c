// Nothing is lost in media whose scattering is tabulated, mixed or different at every wavelength.
#include "support/scene_test.h"
#include "support/scene_test_compare.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

std::string scene(const std::string& phase, const std::string& light) {
    return fmt::format("scene 1\nfilm {{ size 16 16; filter box 0.5 }}\n{}\n"
                       "camera {{ from 0 0 4; look-at 0 0 0; fov 34 deg }}\n{}\n"
                       "shape sphere {{ radius 1; material boundary; interior homogeneous {{ extinction 2 per-m; "
                       "albedo 1; phase p }} }}\n",
                       light, phase);
}

constexpr const char* kDrops = "phase p mie { radius 4 um; spread 0.15 }";
constexpr const char* kTable = "phase p table { values { - 0 300; - 1 200; - 4 12; - 60 0.4; - 120 0.1; - 140 1.2; "
                               "- 150 0.3; - 180 1 } }";
constexpr const char* kMix = "phase p mix { part mie weight=0.6 { radius 1 um }; part rayleigh weight=0.3; "
                             "part henyey-greenstein -0.7 weight=0.1 }";

} // namespace

TEST_CASE("a white ball of drops in a white surrounding cannot be seen, at any wavelength") {
    for (const char* phase : {kDrops, kTable, kMix}) {
        INFO(std::string(phase));
        const TestImage image = render(TestScene::parse(scene(phase, "light sky { radiance 1 }")), 2048);
        // Y = 1, and X and Z those of the even light.
        checkSame(compareExpected(image.film, [](int, int) { return 1.0; }), 0.001);
        for (const Channel channel : {Channel::x, Channel::z}) {
            const auto empty = TestScene::parse("scene 1\nfilm { size 16 16; filter box 0.5 }\ncamera { from 0 0 4; "
                                                "look-at 0 0 0; fov 34 deg }\nlight sky { radiance 1 }\n");
            checkSame(compareImages(image.film, render(empty, 1024, 7).film, channel), 0.001);
        }
        CHECK(image.statistics.dropped == std::array<std::uint64_t, 3>{});
        CHECK(image.statistics.cappedPaths == 0);
    }
}

TEST_CASE("strategies agree where light is scattered at every wavelength in its own way") {
    const std::string emitter =
        "shape sphere { center 0.3 2.2 1; radius 0.5; emission 5; material diffuse { reflectance "
        "0 } }\nlight sky { radiance 0.2 }\n";
    for (const char* phase : {kDrops, kMix}) {
        INFO(std::string(phase));
        const TestScene built = TestScene::parse(scene(phase, emitter));
        const std::vector<TestImage> images = renderByEachStrategy(built, 2048);
        for (const Channel channel : {Channel::x, Channel::y, Channel::z}) {
            checkSame(compareImages(images[0].film, images[1].film, channel), 0.025);
            checkSame(compareImages(images[0].film, images[2].film, channel), 0.025);
        }
    }
}

} // namespace abbe::test
