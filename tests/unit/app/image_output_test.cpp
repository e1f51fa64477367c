// Spaces of images on their way to a view.
#include "io/exr_deep.h"
#include "io/file.h"
#include "io/ocio_view.h"
#include "io/png_writer.h"
#include "pictures/display_view.h"
#include "pictures/image_output.h"
#include "unit/io/temporary_folder.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <doctest/doctest.h>

using namespace abbe;

namespace {

Vec3d inAces(std::array<float, 3> rgb, const RgbSpace& space, Chromaticity neutral) {
    convertToAces(rgb, space, neutral);
    return {rgb[0], rgb[1], rgb[2]};
}

class Environment {
  public:
    Environment(const char* name, const char* value) : name_(name) { ::setenv(name, value, 1); }
    ~Environment() { ::unsetenv(name_); }

  private:
    const char* name_;
};

} // namespace

TEST_CASE("image output: the neutral of each space becomes that of ACES") {
    for (const RgbSpace& space : {rgb::rec709, rgb::rec2020, rgb::p3d65, rgb::ap1})
        CHECK(length(inAces({0.5f, 0.5f, 0.5f}, space, space.white) - Vec3d(0.5, 0.5, 0.5)) < 1e-6);
    const Xyz d65 = whiteXyz(rgb::rec709.white);
    const std::array<float, 3> white{static_cast<float>(d65.x), static_cast<float>(d65.y), static_cast<float>(d65.z)};
    CHECK(length(inAces(white, rgb::xyz, adoptedNeutral(OutputSpace::xyz)) - Vec3d(1, 1, 1)) < 1e-6);
}

TEST_CASE("image output: Rec. 709 reaches ACEScg as the published matrix says") {
    // First column of the matrix from linear sRGB to ACEScg with Bradford's transform, of OpenColorIO's ACES
    // configurations.
    const Vec3d red = inAces({1, 0, 0}, rgb::rec709, rgb::rec709.white);
    const Vec3d ap1 = rgb::ap1.fromXyz().apply<Vec3d>(rgb::ap0.toXyz().apply<Xyz>(red));
    CHECK(length(ap1 - Vec3d(0.613097, 0.070194, 0.020616)) < 2e-6);
}

TEST_CASE("image output: the configuration comes from the option, the environment or the program") {
    const auto nameOf = [](const ViewOptions& o) { return std::get<std::string>(viewIdentity(o)[0].value); };
    ::unsetenv("OCIO");
    ViewOptions options;
    CHECK(nameOf(options) == OcioView::builtInConfig);
    const Environment set("OCIO", "/nowhere/config.ocio");
    CHECK_THROWS_WITH_AS(viewIdentity(options), doctest::Contains("$OCIO"), IoError);
    CHECK_THROWS_WITH_AS(checkView(options, false), doctest::Contains("$OCIO"), IoError);
    CHECK_THROWS_WITH_AS(checkView(options, true), doctest::Contains("$OCIO"), IoError);
    options.config = OcioView::builtInConfig;
    CHECK(nameOf(options) == OcioView::builtInConfig);
    options.config = "/nowhere/else.ocio";
    CHECK_THROWS_WITH_AS(viewIdentity(options), doctest::Contains("else.ocio"), IoError);
    options.config = OcioView::builtInConfig;
    options.view = "Filmic";
    checkView(options, false);
    CHECK_THROWS_WITH_AS(checkView(options, true), doctest::Contains("Filmic"), IoError);
}

TEST_CASE("image output: a PNG is known by its name, and ours by what it says") {
    CHECK(isPngName("a.png"));
    CHECK(isPngName("b/a.PNG"));
    for (const char* name : {"a.jpg", "a", "png", "a.png.exr", ".png"}) CHECK_FALSE(isPngName(name));
    const TemporaryFolder folder;
    CHECK_FALSE(isForeignPng(folder / "absent.png"));
    writeDisplayPng(folder / "ours.png", {1, 1, {0.5f, 0.5f, 0.5f}}, {{}, {}, OcioView::builtInConfig, 0}, 8);
    CHECK_FALSE(isForeignPng(folder / "ours.png"));
    const float grey[3] = {};
    writePng(folder / "other.png", {.width = 1, .height = 1, .rgb = grey, .texts = {{"Software", "abbey 3"}}});
    CHECK(isForeignPng(folder / "other.png"));
    writePng(folder / "none.png", {.width = 1, .height = 1, .rgb = grey});
    CHECK(isForeignPng(folder / "none.png"));
}

TEST_CASE("image output: a deep image is ours by what its header says") {
    const TemporaryFolder folder;
    DeepPicture deep{{0, 0, 1, 1}, {0, 0, 1, 1}, {1}, {1}, {2}, {1}, {0}, {0}, {0}, {}, {}};
    CHECK_FALSE(isForeignDeep(folder / "absent.exr"));
    writeDeepExr(folder / "other.exr", deep);
    CHECK(isForeignDeep(folder / "other.exr"));
    deep.attributes.push_back({"abbe.version", "0"});
    writeDeepExr(folder / "ours.exr", deep);
    CHECK_FALSE(isForeignDeep(folder / "ours.exr"));
    const std::vector<float> grey(1);
    ExrPicture flat{{0, 0, 1, 1}, {0, 0, 1, 1}, grey, grey, grey};
    flat.attributes = deep.attributes;
    writeExr(folder / "flat.exr", flat);
    CHECK(isForeignDeep(folder / "flat.exr"));
    writeAtomically(folder / "text.exr", std::string_view("no picture"));
    CHECK(isForeignDeep(folder / "text.exr"));
}
