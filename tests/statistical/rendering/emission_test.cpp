// Media that shine: what must not be seen of them, and their light by all strategies.
#include "support/made_volumes.h"
#include "support/scene_test.h"
#include "support/scene_test_compare.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

constexpr const char* kEmissionHeader = "scene 1\nfilm { size 16 16; filter box 0.5 }\n";
constexpr const char* kOven = "light sky { radiance blackbody 2000 K }\n";

TestScene seen(const std::string& text) {
    return TestScene::parse(kEmissionHeader +
                            std::string("camera { from 0 0 4; look-at 0 0 0; fov 34 deg; shutter 0.1 s }\n") + text);
}

void checkInvisible(const std::string& text, double resolution, std::uint32_t samples) {
    INFO(text);
    const TestImage with = render(seen(kOven + text), samples), without = render(seen(kOven), samples, 2);
    for (const Channel channel : {Channel::x, Channel::y, Channel::z})
        checkSame(compareImages(with.film, without.film, channel), resolution);
    CHECK(with.statistics.dropped == std::array<std::uint64_t, 3>{});
}

} // namespace

TEST_CASE("a medium in surroundings of its own temperature cannot be seen") {
    const auto ball = [](const char* optics) {
        return fmt::format("shape sphere {{ radius 1; material boundary; interior homogeneous {{ {}; temperature "
                           "2000 K }} }}\n",
                           optics);
    };
    checkInvisible(ball("absorption 0.7 per-m"), 0.006, 512);
    checkInvisible(ball("extinction 3 per-m; albedo 0.7; phase henyey-greenstein 0.6"), 0.006, 512);
    checkInvisible(ball("extinction table 400 0.5 700 4 per-m; albedo table 400 0.9 700 0.2"), 0.01, 1024);
}

TEST_CASE("nor can a volume from a file, in any colour, while it drifts") {
    const MadeVolumes files("emission_test");
    const std::string smoke = files.make("smoke", 40);
    const auto volume = [&](const char* more) {
        return fmt::format("volume vdb {} {{ extinction 4 per-m; albedo 0.6; temperature density scale=0 offset=2000; "
                           "transform {{ translate -0.3 -2.5 0 }}; {} }}\n",
                           smoke, more);
    };
    checkInvisible(volume(""), 0.003, 512);
    checkInvisible(volume("velocity"), 0.003, 512);
    checkInvisible(volume("color velocity; velocity"), 0.003, 512);
}

TEST_CASE("the light of a fire is the same along the way and from its points") {
    const MadeVolumes files("emission_test_fire");
    TestScene scene = seen(fmt::format(
        "shape plane {{ center 0 -1 0; material diffuse }}\n"
        "volume vdb {} {{ temperature; flame; extinction 0.6 per-m; albedo 0.5; emissivity 1.5 per-m; transform {{ "
        "translate 0 -1 0 }} }}\n"
        "volume atmosphere {{ extinction 0.1 per-m; scale-height 1 m; ground -1 m }}\n",
        files.make("fire", 32)));
    REQUIRE(scene.report() == "");
    const std::vector<TestImage> images = renderByEachStrategy(scene, 1024);
    checkSame(compareImages(images[0].film, images[1].film), 0.04);
    checkSame(compareImages(images[0].film, images[2].film), 0.04);
}

} // namespace abbe::test
