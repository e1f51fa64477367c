#include "io/file.h"
#include "io/image.h"
#include "temporary_folder.h"

#include <doctest/doctest.h>
#include <random>

using namespace abbe;

namespace {

const std::string kHead = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n";

std::string bytes(std::initializer_list<int> values) {
    std::string s;
    for (const int v : values) s += static_cast<char>(v);
    return s;
}

RgbImage read(const std::string& content) {
    const TemporaryFolder folder;
    writeAll(folder / "a.hdr", content);
    return readImage(folder / "a.hdr");
}

// One row of eight pixels with the code of version two: runs for red and exponent, plain values for green and blue.
std::string row(int red) {
    return bytes({2, 2, 0, 8, 128 + 8, red, 8, 0, 16, 32, 48, 64, 80, 96, 112, 3, 1, 2, 3, 128 + 5, 9, 128 + 8, 129});
}

} // namespace

TEST_CASE("flat Radiance pictures, by the numbers") {
    // 2^(129 - 136) per step: 128 is 1.
    const RgbImage image = read(kHead + "\n-Y 1 +X 2\n" + bytes({128, 64, 0, 129, 200, 100, 50, 0}));
    CHECK(image.width() == 2);
    CHECK(image.height() == 1);
    CHECK(image.rgb == std::vector<float>{1, 0.5f, 0, 0, 0, 0});
    CHECK(!image.chromaticities);
}

TEST_CASE("run-length coded Radiance pictures in all row orders") {
    const RgbImage down = read(kHead + "\n-Y 2 +X 8\n" + row(128) + row(64));
    CHECK(down.rgb[0] == 1);
    CHECK(down.rgb[3 * 8] == 0.5f);
    CHECK(down.rgb[3 * 3 + 1] == 48.f / 128);
    CHECK(down.rgb[3 * 2 + 2] == 3.f / 128);
    CHECK(down.rgb[3 * 7 + 2] == 9.f / 128);
    const RgbImage up = read(kHead + "\n+Y 2 -X 8\n" + row(128) + row(64));
    CHECK(up.rgb[0] == 0.5f);
    CHECK(up.rgb[3 * 8] == 1);
    CHECK(up.rgb[3 * 4 + 1] == 48.f / 128);
}

TEST_CASE("exposure is undone and primaries are kept") {
    const RgbImage image = read("#?RGBE\n# comment\nEXPOSURE=2\nEXPOSURE= 4\nCOLORCORR= 1 2 1\n"
                                "PRIMARIES= 0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329\n"
                                "FORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n" +
                                bytes({128, 128, 128, 129}));
    CHECK(image.rgb == std::vector<float>{0.125f, 0.0625f, 0.125f});
    REQUIRE(image.chromaticities);
    CHECK(image.chromaticities->space().name == rgb::rec709.name);
}

TEST_CASE("old repeat codes of Radiance") {
    const RgbImage image = read(kHead + "\n-Y 1 +X 4\n" + bytes({128, 0, 0, 129, 1, 1, 1, 2, 0, 128, 0, 129}));
    CHECK(image.rgb[6] == 1);
    CHECK(image.rgb[9 + 1] == 1);
}

TEST_CASE("damaged Radiance files are errors, never hangs") {
    const std::string good = kHead + "\n-Y 2 +X 8\n" + row(128) + row(64);
    for (std::size_t length = 0; length < good.size(); ++length) {
        CAPTURE(length);
        CHECK_THROWS_AS(read(good.substr(0, length)), IoError);
    }
    for (const char* size : {"-Y 0 +X 8", "-Y -2 +X 8", "-Y 1000000 +X 1000000", "+X 8 -Y 2", "", "-Y 16384 +X 16384"})
        CHECK_THROWS_AS(read(kHead + "\n" + size + "\n" + row(128)), IoError);
    CHECK_THROWS_AS(read("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n" + bytes({1, 2, 3, 4})), IoError);
    CHECK_THROWS_AS(read("#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\n" + bytes({1, 2, 3, 4})), IoError);
    CHECK_THROWS_AS(read(kHead + "\n-Y 1 +X 8\n" + bytes({2, 2, 0, 8, 128 + 9, 1})), IoError); // run beyond the row
    CHECK_THROWS_AS(read(kHead + "\n-Y 1 +X 8\n" + bytes({2, 2, 0, 8, 0, 0, 0, 0})), IoError); // empty run
    CHECK_THROWS_AS(read(kHead + "\n-Y 1 +X 8\n" + bytes({2, 2, 0, 9, 136, 0, 0, 0})), IoError);
    CHECK_THROWS_AS(read(kHead + "\n-Y 1 +X 4\n" + bytes({1, 1, 1, 3})), IoError); // nothing to repeat
    std::mt19937 random(4);
    for (int i = 0; i < 300; ++i) {
        std::string damaged = good;
        for (int k = 0; k < 4; ++k) damaged[random() % damaged.size()] = static_cast<char>(random());
        try {
            read(damaged);
        } catch (const IoError&) {
        }
    }
}

TEST_CASE("environment maps of the shared data") {
    const std::string folder = std::string(ABBE_SOURCE_DIR) + "/../shared/data/hdr";
    if (!std::filesystem::exists(folder)) return;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const auto extension = entry.path().extension();
        if (extension != ".hdr" && extension != ".exr") continue;
        const RgbImage image = readImage(entry.path().string());
        CHECK(image.rgb.size() == 3 * image.window.area());
        CHECK(image.nonFinite == 0);
    }
}
