// Volumes of several grids: what the language says of them, and what is said about wrong ones.
#include "media/grid_medium.h"
#include "scene_test_fixture.h"
#include "support/made_volumes.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

struct Files {
    MadeVolumes folder{"volumes_test"};
    std::string fire = folder.make("fire", 32), smoke = folder.make("smoke", 32), candle = folder.make("candle", 32);
};

// Made once for all tests, which takes half a second.
const Files& madeFiles() {
    static const Files files;
    return files;
}

std::string volume(const std::string& file, const std::string& properties) {
    return "volume vdb " + file + " { " + properties + " }\n";
}

const GridMedium& only(const TestScene& scene) {
    REQUIRE(scene.scene().openMedia.size() == 1);
    return dynamic_cast<const GridMedium&>(*scene.scene().openMedia[0]);
}

} // namespace

TEST_CASE("volumes: grids by their usual names, by `grid=` and by name, with factors") {
    const Files& files = madeFiles();
    for (const char* text :
         {"temperature; flame; emissivity 2 per-m",
          "temperature grid=temperature; flame grid=flame; emissivity 2 per-m",
          "density density scale=1; temperature \"temperature\" scale=1 offset=0; flame flame; emissivity 2 per-m"}) {
        const auto scene = build(volume(files.fire, text));
        REQUIRE(scene.report() == "");
        CHECK(only(scene).emission());
        CHECK_FALSE(only(scene).albedoVaries());
        REQUIRE(scene.scene().lights.size() == 2);
        CHECK(scene.scene().lights[1]->emission() == only(scene).emission());
        CHECK(scene.scene().lights[1]->power() > 100);
    }
    const auto once = build(volume(files.candle, "temperature; flame; albedo 0.2"));
    const auto twice = build(volume(files.candle, "temperature; flame scale=2; albedo 0.2"));
    CHECK(twice.scene().lights[1]->power() == doctest::Approx(2 * once.scene().lights[1]->power()).epsilon(0.05));
    // No light of what has no glow.
    CHECK(build(volume(files.fire, "")).scene().lights.size() == 1);
    CHECK(build(volume(files.fire, "density flame")).report() == "");
    // A glow of the density itself.
    CHECK(build(volume(files.smoke, "emission rgb 0.1 0.4 1")).scene().lights.size() == 2);
}

TEST_CASE("volumes: velocity drifts while the shutter is open, from the moment of the file") {
    const Files& files = madeFiles();
    const auto drift = [&](const std::string& shutter, const std::string& properties) {
        const auto scene = TestScene::parse("scene 1\ncamera { from 0 0 5; look-at 0 0 0; shutter " + shutter + " }\n" +
                                            kSky + volume(files.smoke, properties));
        INFO(scene.report());
        REQUIRE(scene.report() == "");
        return only(scene).drift();
    };
    CHECK(drift("0.1 s", "velocity") > 0.5);
    CHECK(drift("0.2 s", "velocity velocity") == doctest::Approx(2 * drift("0.1 s", "velocity")));
    CHECK(drift("0.1 s", "velocity scale=-3") == doctest::Approx(3 * drift("0.1 s", "velocity")));
    CHECK(drift("0.1 s", "velocity; time -0.1 s") == doctest::Approx(2 * drift("0.1 s", "velocity")));
    CHECK(drift("0.1 s", "velocity; transform { scale 7; rotate y 20 deg }") ==
          doctest::Approx(drift("0.1 s", "velocity")).epsilon(0.5));
    CHECK(drift("0.1 s", "velocity scale=0") == 0);
    CHECK(drift("0.1 s", "") == 0);
}

TEST_CASE("volumes: colour is clamped aloud") {
    const Files& files = madeFiles();
    const auto scene = build(volume(files.smoke, "color velocity"));
    CHECK(codes(scene) == "W0692");
    CHECK(only(scene).albedoVaries());
    CHECK(only(scene).needs() == Effects(Effect::media));
}

TEST_CASE("volumes: wrong names, kinds and combinations are located and explained") {
    const Files& files = madeFiles();
    const auto says = [&](const std::string& file, const std::string& text, const std::string& code,
                          const std::string& advice) {
        const auto scene = build(volume(file, text));
        INFO(text << ": " << scene.report() << scene.advice());
        CHECK(codes(scene) == code);
        CHECK((scene.report() + scene.advice()).find(advice) != std::string::npos);
    };
    says(files.fire, "temperature heat; albedo 0.5", "E0643", "density, flame, temperature");
    says(files.fire, "density smoke", "E0643", "test.scene:4:");
    says(files.fire, "velocity", "E0643", "no grid `velocity`");
    says(files.smoke, "density velocity", "E0642", "a grid of numbers");
    says(files.smoke, "temperature velocity; albedo 0", "E0642", "a grid of numbers");
    says(files.smoke, "velocity density", "E0642", "a grid of vectors");
    says(files.smoke, "color density", "E0642", "a grid of vectors");
    says(files.fire, "temperature", "E0647", "absorbs nothing");
    says(files.fire, "emissivity 1", "E0647", "`temperature`");
    says(files.fire, "emission 1; temperature", "E0647", "stands alone");
    says(files.fire, "flame", "E0647", "`flame`");
    says(files.fire, "temperature scale=0.001; albedo 0", "W0693", "kelvin");
    says(files.fire, "temperature scale=1e9; albedo 0", "E0647", "hottest");
    says(files.smoke, "velocity scale=1e6; time 1 s", "E0646", "256");
    says(files.fire, "density scale=-1", "E0303", "between 0");
    says(files.fire, "density factor=1", "E0210", "`grid`");
    says(files.fire, "density density grid=flame", "E0306", "again");
    says(files.fire, "density scale=big", "E0314", "number");
    says(files.fire, "density grid=3", "E0314", "quotes");
    says(files.fire, "grid density", "E0201", "density");
}

TEST_CASE("media that fill shapes shine with a spectrum or a temperature") {
    const auto shines = [](const std::string& optics) {
        return build("shape sphere { material boundary; interior homogeneous { " + optics + " } }\n");
    };
    CHECK(shines("emission 0.5").report() == "");
    CHECK(shines("absorption 2 per-m; temperature 1900 K").report() == "");
    CHECK(shines("emissivity 2 per-m; temperature 1900 K").report() == "");
    CHECK(codes(shines("temperature 1900 K")) == "E0647");
    CHECK(codes(shines("emissivity 2 per-m")) == "E0647");
}

} // namespace abbe::test
