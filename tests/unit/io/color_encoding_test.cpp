// Decoding of pictures against OpenColorIO, which is not used for it.
#include "io/data/ocio_config.h"
#include "spectrum/color_space.h"

#include <OpenColorIO/OpenColorIO.h>
#include <cmath>
#include <doctest/doctest.h>
#include <sstream>

using namespace abbe;

TEST_CASE("color encoding: as OpenColorIO decodes") {
    std::istringstream stream(kOcioConfig);
    const auto config = OCIO_NAMESPACE::Config::CreateFromStream(stream);
    const struct {
        const char *ours, *theirs;
        double tolerance;
    } cases[] = {{"srgb_rec709_scene", "sRGB - Display", 1e-5}};
    for (const auto& c : cases) {
        const auto cpu = config->getProcessor(c.theirs, "CIE-XYZ-D65")->getDefaultCPUProcessor();
        const ColorEncoding* const encoding = findColorEncoding(c.ours);
        REQUIRE(encoding);
        for (int i = 0; i < 1000; ++i) {
            const double r = i % 10 / 9.0, g = i / 10 % 10 / 9.0, b = i / 100 / 9.0;
            float pixel[3] = {static_cast<float>(r), static_cast<float>(g), static_cast<float>(b)};
            cpu->applyRGB(pixel);
            const Xyz xyz =
                toXyz({encoding->toLinear(r), encoding->toLinear(g), encoding->toLinear(b)}, *encoding->space);
            CHECK(std::abs(xyz.x - static_cast<double>(pixel[0])) < 2e-4); // their white is rounded
            CHECK(std::abs(xyz.y - static_cast<double>(pixel[1])) < 2e-4);
            CHECK(std::abs(xyz.z - static_cast<double>(pixel[2])) < 2e-4);
        }
    }
    const auto linear = config->getProcessor("ACEScg", "ACES2065-1")->getDefaultCPUProcessor();
    float pixel[3] = {0.6f, 0.3f, 0.1f};
    linear->applyRGB(pixel);
    const Xyz xyz = toXyz({0.6, 0.3, 0.1}, *findColorEncoding("ACEScg")->space);
    const Vec3d ap0 = toRgb(xyz, *findColorEncoding("aces2065-1")->space);
    CHECK(ap0.x == doctest::Approx(static_cast<double>(pixel[0])).epsilon(1e-4));
    CHECK(ap0.z == doctest::Approx(static_cast<double>(pixel[2])).epsilon(1e-4));
}

TEST_CASE("color encoding: names, tags and primaries") {
    for (const std::string_view name : colorEncodingNames()) {
        const ColorEncoding* const e = findColorEncoding(name);
        REQUIRE(e);
        CHECK(e->name == name);
        CHECK(e->toLinear(0) == 0);
        CHECK(e->toLinear(1) == 1);
        CHECK(e->toLinear(-0.3) == -e->toLinear(0.3));
    }
    CHECK(findColorEncoding("sRGB")->name == "srgb_rec709_scene");
    CHECK(!findColorEncoding("raw")->space);
    CHECK(!findColorEncoding("Panavision 1958"));
    for (const std::string_view name : rgbSpaceNames()) { // a word of the language means one space
        REQUIRE(findColorEncoding(name));
        CHECK(findColorEncoding(name)->space->name == findRgbSpace(name)->name);
        CHECK(findColorEncoding(name)->curve == TransferCurve::linear);
    }
    const RgbSpace& p3 = rgb::p3d65;
    CHECK(findColorEncoding(p3.red, p3.green, p3.blue, p3.white)->name == "lin_p3d65_scene");
    CHECK(!findColorEncoding({0.7, 0.2}, p3.green, p3.blue, p3.white));
}
